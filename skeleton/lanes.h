#pragma once

// Four numbers at a time, one in each lane of a vector unit. For kernels only, in .cpp files: what is here is
// compiled into each of their versions, for the processors that PALPATE_CLONES names and for any other.

#include "mesh/system/clones.h"

namespace palpate::skeleton::lanewise {

constexpr int lanes = 4;
using Lanes = double __attribute__((vector_size(lanes * sizeof(double))));
using LaneMask = decltype(Lanes{} > Lanes{});

PALPATE_INLINE Lanes all(double a) { return Lanes{a, a, a, a}; }
// In memory they need not be aligned. Clang takes an alignment from a typedef, from an alias it does not.
typedef double LanesInMemory __attribute__((vector_size(lanes * sizeof(double)), aligned(8), may_alias));
PALPATE_INLINE Lanes at(const double* p) { return *reinterpret_cast<const LanesInMemory*>(p); }
PALPATE_INLINE void put(double* p, Lanes a) { *reinterpret_cast<LanesInMemory*>(p) = a; }
PALPATE_INLINE Lanes pick(LaneMask yes, Lanes a, Lanes b) { return yes ? a : b; }
PALPATE_INLINE Lanes larger(Lanes a, Lanes b) { return a > b ? a : b; }
PALPATE_INLINE Lanes smaller(Lanes a, Lanes b) { return a < b ? a : b; }
PALPATE_INLINE Lanes magnitude(Lanes a) { return a < 0 ? -a : a; }
PALPATE_INLINE Lanes root(Lanes a) {
    Lanes r;
    for (int i = 0; i < lanes; ++i) r[i] = __builtin_sqrt(a[i]);
    return r;
}

struct Lanes3 {
    Lanes x, y, z;
};
PALPATE_INLINE Lanes3 operator+(const Lanes3& a, const Lanes3& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
PALPATE_INLINE Lanes3 operator-(const Lanes3& a, const Lanes3& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
PALPATE_INLINE Lanes3 operator*(Lanes a, const Lanes3& b) { return {a * b.x, a * b.y, a * b.z}; }
PALPATE_INLINE Lanes dot(const Lanes3& a, const Lanes3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
PALPATE_INLINE Lanes3 cross(const Lanes3& a, const Lanes3& b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

/// A quaternion: the vector part, then the scalar one.
struct Lanes4 {
    Lanes x, y, z, w;
    Lanes3 vector() const { return {x, y, z}; }
};
/// v turned by the unit quaternion q: v + 2 w (q x v) + 2 q x (q x v).
PALPATE_INLINE Lanes3 turned(const Lanes4& q, const Lanes3& v) {
    const Lanes3 u = q.vector(), t = all(2) * cross(u, v);
    return v + q.w * t + cross(u, t);
}
/// p q.
PALPATE_INLINE Lanes4 product(const Lanes4& p, const Lanes4& q) {
    return {p.w * q.x + p.x * q.w + p.y * q.z - p.z * q.y, p.w * q.y - p.x * q.z + p.y * q.w + p.z * q.x,
            p.w * q.z + p.x * q.y - p.y * q.x + p.z * q.w, p.w * q.w - p.x * q.x - p.y * q.y - p.z * q.z};
}
PALPATE_INLINE Lanes4 conjugate(const Lanes4& q) { return {-q.x, -q.y, -q.z, q.w}; }
/// The same rotation with w >= 0.
PALPATE_INLINE Lanes4 upright(const Lanes4& q) {
    const LaneMask down = q.w < 0;
    return {pick(down, -q.x, q.x), pick(down, -q.y, q.y), pick(down, -q.z, q.z), pick(down, -q.w, q.w)};
}

/// Four rows of four, transposed: lane i of the k-th result is entry k of row i.
PALPATE_INLINE Lanes4 transposed(Lanes a, Lanes b, Lanes c, Lanes d) {
    const Lanes ab_even = __builtin_shufflevector(a, b, 0, 4, 2, 6), ab_odd = __builtin_shufflevector(a, b, 1, 5, 3, 7);
    const Lanes cd_even = __builtin_shufflevector(c, d, 0, 4, 2, 6), cd_odd = __builtin_shufflevector(c, d, 1, 5, 3, 7);
    return {__builtin_shufflevector(ab_even, cd_even, 0, 1, 4, 5), __builtin_shufflevector(ab_odd, cd_odd, 0, 1, 4, 5),
            __builtin_shufflevector(ab_even, cd_even, 2, 3, 6, 7), __builtin_shufflevector(ab_odd, cd_odd, 2, 3, 6, 7)};
}
/// Rows `at[i]` of a table whose rows are `stride` long, from `offset` on.
PALPATE_INLINE Lanes4 gathered(const double* table, const int* row, int stride, int offset) {
    const double* p = table + offset;
    return transposed(at(p + static_cast<long>(stride) * row[0]), at(p + static_cast<long>(stride) * row[1]),
                      at(p + static_cast<long>(stride) * row[2]), at(p + static_cast<long>(stride) * row[3]));
}
/// Adds lane i of (v, 0) to row `row[i]`, lane by lane: rows may be the same.
PALPATE_INLINE void scatter_add(double* table, const int* row, int stride, int offset, const Lanes3& v) {
    const Lanes4 rows = transposed(v.x, v.y, v.z, all(0));
    double* p = table + offset;
    const Lanes of_row[lanes] = {rows.x, rows.y, rows.z, rows.w};
    for (int i = 0; i < lanes; ++i) {
        double* to = p + static_cast<long>(stride) * row[i];
        put(to, at(to) + of_row[i]);
    }
}

/// atan u for |u| <= tan(pi/8): u + u^3 P(u^2), P the polynomial that meets the series (atan u - u) / u^3 = -1/3 +
/// u^2/5
/// - ... at 11 Chebyshev points of [0, tan^2(pi/8)]; it is off by 5e-18 at most.
PALPATE_INLINE Lanes small_angle(Lanes u) {
    const Lanes z = u * u;
    Lanes P = all(-0.019174543572021332);
    P = P * z + 0.03922974453661223;
    P = P * z - 0.05085383488842831;
    P = P * z + 0.058581362519061465;
    P = P * z - 0.06664509989818045;
    P = P * z + 0.07692183087342026;
    P = P * z - 0.0909090457366906;
    P = P * z + 0.11111111015146714;
    P = P * z - 0.1428571428466518;
    P = P * z + 0.19999999999995513;
    P = P * z - 0.3333333333333333;
    return u + u * z * P;
}

/// The angle of the point (c, s) in [0, pi] for s >= 0, not both 0: folded to [0, pi/8] by reflection at pi/2 and pi/4
/// and the tangent's addition theorem.
PALPATE_INLINE Lanes angle(Lanes s, Lanes c) {
    const Lanes size = magnitude(c);
    const Lanes low = smaller(s, size), high = larger(s, size);
    const LaneMask steep = low > 0.4142135623730950488 * high;
    Lanes a = small_angle(pick(steep, low - high, low) / pick(steep, low + high, high));
    a = pick(steep, a + 0.78539816339744830962, a);
    a = pick(s > size, 1.57079632679489661923 - a, a);
    return pick(c < 0, 3.14159265358979323846 - a, a);
}

}  // namespace palpate::skeleton::lanewise
