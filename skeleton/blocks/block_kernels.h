#pragma once

namespace palpate::skeleton {

/// A 6 x 6 block, its columns filled up to eight numbers, so that vector units take one in few steps.
struct alignas(64) PaddedBlock {
    double columns[6][8];

    double& operator()(int i, int j) { return columns[j][i]; }
    double operator()(int i, int j) const { return columns[j][i]; }
};

/// *place[rows[i]] -= L[i] L[0]^T for i in [0, count).
void subtract_products(const PaddedBlock* L, const int* rows, int count, PaddedBlock* const* place);

/// A[i] <- A[i] L^-T for i in [0, count), L lower triangular.
void divide_by_transpose(const PaddedBlock& L, PaddedBlock* A, int count);

/// One column of a block factor: L[0] on the diagonal at j, below it L[1 + i] at rows[i]. `x`: eight numbers a row.
/// x_j <- L_jj^-1 x_j, then x_i -= L_ij x_j.
void solve_forward(const PaddedBlock* L, const int* rows, int count, int j, double* x);
/// x_j <- L_jj^-T (x_j - sum L_ij^T x_i).
void solve_backward(const PaddedBlock* L, const int* rows, int count, int j, double* x);

}  // namespace palpate::skeleton
