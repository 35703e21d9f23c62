#include "fem/linear_algebra/multigrid/chebyshev.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <random>

#include "fem/linear_algebra/blocks/vectors.h"
#include "mesh/errors.h"

namespace palpate::fem {

namespace {

constexpr int degree = 2;            // products with A in a smoothing
constexpr double damped = 15;        // largest eigenvalue over the least that is damped
constexpr int lanczos_steps = 15;    // find the largest eigenvalue to some percent
constexpr double from_below = 1.05;  // of what they find

/// d <- keep d + take D^-1 r, x += d
template <int b>
void advance(const BlockMatrix<b, b>& inverse_diagonal, const MultiVector& r, double keep, double take, MultiVector& d,
             MultiVector& x) {
    for_parts(inverse_diagonal.rows(), [&](Eigen::Index first, Eigen::Index nodes) {
        for (Eigen::Index i = first; i < first + nodes; ++i) {
            const Eigen::Matrix<double, b, b> D = take * inverse_diagonal.block(static_cast<int>(i), 0);
            auto step = d.middleRows<b>(b * i);
            step = keep * step + D.lazyProduct(r.middleRows<b>(b * i));
            x.middleRows<b>(b * i) += step;
        }
    });
}

}  // namespace

template <int b>
BlockMatrix<b, b> inverse_diagonal(const BlockMatrix<b, b>& A) {
    using Square = Eigen::Matrix<double, b, b>;
    BlockMatrix<b, b> result;
    result.columns = A.rows();
    for (int i = 0; i < A.rows(); ++i) {
        result.start.push_back(i + 1);
        result.column.push_back(i);
    }
    result.values.resize(static_cast<std::size_t>(b) * b * A.rows());
    for (int i = 0; i < A.rows(); ++i) {
        const auto columns = A.columns_of(i);
        const auto at = std::ranges::lower_bound(columns, i) - columns.begin();
        Square D = A.block(i, static_cast<int>(at));
        const Eigen::Array<bool, b, 1> free = D.diagonal().array() == 0;
        D.diagonal() += free.template cast<double>().matrix();
        const Eigen::LLT<Square> factor(D);
        if (factor.info() != Eigen::Success) {
            throw SolverFailure(
                "The stiffness matrix is singular: a node can move without resistance. Repair the mesh there.");
        }
        Square inverse = factor.solve(Square::Identity());
        inverse.diagonal() -= free.template cast<double>().matrix();
        result.block(i, 0) = inverse;
    }
    return result;
}

template <int b>
double largest_eigenvalue(const BlockMatrix<b, b>& A, const BlockMatrix<b, b>& inverse_diagonal) {
    std::mt19937 engine(1);
    std::uniform_real_distribution<double> uniform(-1, 1);
    MultiVector r(Eigen::Index{b} * A.rows(), 1), z(r.rows(), 1), Ap(r.rows(), 1);
    for (Eigen::Index i = 0; i < r.rows(); ++i) r(i, 0) = uniform(engine);
    multiply(inverse_diagonal, r, z);
    MultiVector p = z;
    double rz = dots(r, z)(0), last_alpha = 1, last_beta = 0;
    // T = L^T D L, with 1/alpha on D and sqrt(beta) below the diagonal of L.
    Eigen::VectorXd diagonal(lanczos_steps), beside(lanczos_steps);
    int steps = 0;
    while (steps < lanczos_steps && rz > 0) {
        multiply(A, p, Ap);
        const double curvature = dots(p, Ap)(0);
        if (!(curvature > 0)) break;
        const double alpha = rz / curvature;
        r -= alpha * Ap;
        multiply(inverse_diagonal, r, z);
        const double beta = dots(r, z)(0) / rz;
        diagonal(steps) = 1 / alpha + last_beta / last_alpha;
        beside(steps) = std::sqrt(std::max(beta, 0.0)) / alpha;
        ++steps;
        p = z + beta * p;
        rz *= beta;
        last_alpha = alpha, last_beta = beta;
    }
    if (steps == 0) return 1;
    Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver;
    solver.computeFromTridiagonal(diagonal.head(steps), beside.head(steps - 1), Eigen::EigenvaluesOnly);
    return solver.eigenvalues().maxCoeff();
}

template <int b>
Chebyshev<b>::Chebyshev(BlockMatrix<b, b> inverse_diagonal, double largest_eigenvalue)
    : inverse_diagonal_(std::move(inverse_diagonal)) {
    const double top = from_below * largest_eigenvalue, bottom = top / damped;
    middle_ = (top + bottom) / 2;
    radius_ = (top - bottom) / 2;
}

template <int b>
void Chebyshev<b>::smooth(const BlockMatrix<b, b, float>& A, MultiVector& x, MultiVector& residual,
                          bool keep_residual) const {
    // d_1 = D^-1 r / middle, then d_k+1 = rho_k+1 rho_k d_k + 2 rho_k+1 / radius D^-1 r. [Saad 2003, algorithm 12.1]
    const double sigma = middle_ / radius_;
    double rho = 1 / sigma;
    double keep = 0, take = 1 / middle_;
    MultiVector d = MultiVector::Zero(x.rows(), x.cols());
    for (int k = 1; k <= degree; ++k) {
        advance(inverse_diagonal_, residual, keep, take, d, x);
        if (k < degree || keep_residual) multiply(A, d, residual, Join::subtract);
        const double next = 1 / (2 * sigma - rho);
        keep = next * rho;
        take = 2 * next / radius_;
        rho = next;
    }
}

template BlockMatrix<3, 3> inverse_diagonal(const BlockMatrix<3, 3>&);
template BlockMatrix<6, 6> inverse_diagonal(const BlockMatrix<6, 6>&);
template double largest_eigenvalue(const BlockMatrix<3, 3>&, const BlockMatrix<3, 3>&);
template double largest_eigenvalue(const BlockMatrix<6, 6>&, const BlockMatrix<6, 6>&);
template class Chebyshev<3>;
template class Chebyshev<6>;

}  // namespace palpate::fem
