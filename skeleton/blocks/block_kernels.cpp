#include "skeleton/blocks/block_kernels.h"

#include "skeleton/lanes.h"

namespace palpate::skeleton {

using namespace lanewise;

#ifdef __wasm_simd128__

namespace {

// WebAssembly's vectors hold two numbers: a block's six rows are three of them, and three columns at a time are as many
// as a processor behind it keeps in registers.
using Two = double __attribute__((vector_size(16)));
struct Six {
    Two a, b, c;
};
PALPATE_INLINE Six six(const double* p) {
    const Two* q = reinterpret_cast<const Two*>(p);
    return {q[0], q[1], q[2]};
}
PALPATE_INLINE void put(double* p, const Six& v) {
    Two* q = reinterpret_cast<Two*>(p);
    q[0] = v.a, q[1] = v.b, q[2] = v.c;
}
PALPATE_INLINE void subtract(Six& from, const Six& v, double times) {
    const Two t{times, times};
    from.a -= v.a * t, from.b -= v.b * t, from.c -= v.c * t;
}

PALPATE_INLINE void subtract_in_columns(int first, const PaddedBlock& A, const PaddedBlock& by, PaddedBlock& C) {
    Six x = six(C.columns[first]), y = six(C.columns[first + 1]), z = six(C.columns[first + 2]);
    for (int m = 0; m < 6; ++m) {
        const Six v = six(A.columns[m]);
        subtract(x, v, by.columns[m][first]);
        subtract(y, v, by.columns[m][first + 1]);
        subtract(z, v, by.columns[m][first + 2]);
    }
    put(C.columns[first], x);
    put(C.columns[first + 1], y);
    put(C.columns[first + 2], z);
}

}  // namespace

void subtract_products(const PaddedBlock* L, const int* rows, int count, PaddedBlock* const* place) {
    for (int i = 0; i < count; ++i) {
        subtract_in_columns(0, L[i], L[0], *place[rows[i]]);
        subtract_in_columns(3, L[i], L[0], *place[rows[i]]);
    }
}

void divide_by_transpose(const PaddedBlock& L, PaddedBlock* A, int count) {
    for (int i = 0; i < count; ++i) {
        for (int c = 0; c < 6; ++c) {
            Six x = six(A[i].columns[c]);
            for (int m = 0; m < c; ++m) subtract(x, six(A[i].columns[m]), L.columns[m][c]);
            const double inverse = 1 / L.columns[c][c];
            put(A[i].columns[c], Six{x.a * inverse, x.b * inverse, x.c * inverse});
        }
    }
}

void solve_forward(const PaddedBlock* L, const int* rows, int count, int j, double* x) {
    double* own = x + 8L * j;
    for (int c = 0; c < 6; ++c) {
        own[c] /= L->columns[c][c];
        for (int i = c + 1; i < 6; ++i) own[i] -= L->columns[c][i] * own[c];
    }
    for (int i = 0; i < count; ++i) {
        double* to = x + 8L * rows[i];
        Six sum = six(to);
        for (int m = 0; m < 6; ++m) subtract(sum, six(L[1 + i].columns[m]), own[m]);
        put(to, sum);
    }
}

void solve_backward(const PaddedBlock* L, const int* rows, int count, int j, double* x) {
    double* own = x + 8L * j;
    Two sum[6] = {};
    for (int i = 0; i < count; ++i) {
        const Six from = six(x + 8L * rows[i]);
        for (int m = 0; m < 6; ++m) {
            const Six A = six(L[1 + i].columns[m]);
            sum[m] += A.a * from.a + A.b * from.b + A.c * from.c;
        }
    }
    for (int c = 5; c >= 0; --c) {
        double value = own[c] - (sum[c][0] + sum[c][1]);
        for (int i = c + 1; i < 6; ++i) value -= L->columns[c][i] * own[i];
        own[c] = value / L->columns[c][c];
    }
}

#else

PALPATE_CLONES void subtract_products(const PaddedBlock* L, const int* rows, int count, PaddedBlock* const* place) {
    const PaddedBlock& by = L[0];
    for (int i = 0; i < count; ++i) {
        PaddedBlock& C = *place[rows[i]];
        Lanes high[6], low[6];
        for (int c = 0; c < 6; ++c) {
            high[c] = at(C.columns[c]);
            low[c] = at(C.columns[c] + lanes);
        }
        for (int m = 0; m < 6; ++m) {
            const Lanes h = at(L[i].columns[m]), l = at(L[i].columns[m] + lanes);
            for (int c = 0; c < 6; ++c) {
                high[c] -= h * by.columns[m][c];
                low[c] -= l * by.columns[m][c];
            }
        }
        for (int c = 0; c < 6; ++c) {
            put(C.columns[c], high[c]);
            put(C.columns[c] + lanes, low[c]);
        }
    }
}

PALPATE_CLONES void divide_by_transpose(const PaddedBlock& L, PaddedBlock* A, int count) {
    double inverse[6];
    for (int c = 0; c < 6; ++c) inverse[c] = 1 / L.columns[c][c];
    for (int i = 0; i < count; ++i) {
        for (int c = 0; c < 6; ++c) {
            Lanes high = at(A[i].columns[c]), low = at(A[i].columns[c] + lanes);
            for (int m = 0; m < c; ++m) {
                high -= at(A[i].columns[m]) * L.columns[m][c];
                low -= at(A[i].columns[m] + lanes) * L.columns[m][c];
            }
            put(A[i].columns[c], high * inverse[c]);
            put(A[i].columns[c] + lanes, low * inverse[c]);
        }
    }
}

PALPATE_CLONES void solve_forward(const PaddedBlock* L, const int* rows, int count, int j, double* x) {
    double* own = x + 8L * j;
    for (int c = 0; c < 6; ++c) {
        own[c] /= L->columns[c][c];
        for (int i = c + 1; i < 6; ++i) own[i] -= L->columns[c][i] * own[c];
    }
    for (int i = 0; i < count; ++i) {
        const PaddedBlock& A = L[1 + i];
        double* to = x + 8L * rows[i];
        Lanes high{}, low{};
        for (int m = 0; m < 6; ++m) {
            high += at(A.columns[m]) * own[m];
            low += at(A.columns[m] + lanes) * own[m];
        }
        put(to, at(to) - high);
        put(to + lanes, at(to + lanes) - low);
    }
}

PALPATE_CLONES void solve_backward(const PaddedBlock* L, const int* rows, int count, int j, double* x) {
    double* own = x + 8L * j;
    Lanes sum[6] = {};
    for (int i = 0; i < count; ++i) {
        const PaddedBlock& A = L[1 + i];
        const double* from = x + 8L * rows[i];
        const Lanes high = at(from), low = at(from + lanes);
        for (int m = 0; m < 6; ++m) sum[m] += at(A.columns[m]) * high + at(A.columns[m] + lanes) * low;
    }
    for (int c = 5; c >= 0; --c) {
        double value = own[c] - (sum[c][0] + sum[c][1] + sum[c][2] + sum[c][3]);
        for (int i = c + 1; i < 6; ++i) value -= L->columns[c][i] * own[i];
        own[c] = value / L->columns[c][c];
    }
}

#endif

}  // namespace palpate::skeleton
