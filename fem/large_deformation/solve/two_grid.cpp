#include "fem/large_deformation/solve/two_grid.h"

#include <cmath>

#include "fem/linear_algebra/blocks/vectors.h"

namespace palpate::fem {
namespace {

constexpr int most_steps = 20;  // 3 to 7 are taken; an answer to half of a step's length is still a step

std::vector<int> free_nodes(const std::vector<char>& held) {
    std::vector<int> free;
    for (std::size_t n = 0; n < held.size(); ++n)
        if (!held[n]) free.push_back(static_cast<int>(n));
    return free;
}

/// The blocks of some nodes. @pre J is symmetric, with whole blocks, as those of nodes are.
BlockMatrix<3, 3> blocks_of(const Eigen::SparseMatrix<double>& J, const std::vector<int>& nodes) {
    using Column = Eigen::SparseMatrix<double>::InnerIterator;
    std::vector<int> number(static_cast<std::size_t>(J.cols()) / 3, -1);
    for (std::size_t i = 0; i < nodes.size(); ++i) number[nodes[i]] = static_cast<int>(i);
    std::vector<std::vector<int>> neighbours(nodes.size());
    for (std::size_t i = 0; i < nodes.size(); ++i) {
        for (Column entry(J, 3 * nodes[i]); entry; ++entry) {
            const int other = number[entry.row() / 3];
            if (entry.row() % 3 == 0 && other >= 0) neighbours[i].push_back(other);
        }
    }
    BlockMatrix<3, 3> A = with_pattern<3, 3>(neighbours, static_cast<int>(nodes.size()));
    for (std::size_t i = 0; i < nodes.size(); ++i) {
        for (int c = 0; c < 3; ++c) {
            int k = -1;
            for (Column entry(J, 3 * nodes[i] + c); entry; ++entry) {
                if (number[entry.row() / 3] < 0) continue;
                if (entry.row() % 3 == 0) ++k;
                A.block(static_cast<int>(i), k)(c, entry.row() % 3) = entry.value();
            }
        }
    }
    return A;
}

Chebyshev<3> smoother_of(const BlockMatrix<3, 3>& A) {
    BlockMatrix<3, 3> inverse = inverse_diagonal(A);
    const double largest = largest_eigenvalue(A, inverse);
    return {std::move(inverse), largest};
}

}  // namespace

TwoGrid::TwoGrid(const Eigen::SparseMatrix<double>& J, const std::vector<char>& held,
                 const Interpolation& interpolation, const BodyTangent& coarse)
    : free_(free_nodes(held)),
      J_(blocks_of(J, free_)),
      rounded_(rounded(J_)),
      smoother_(smoother_of(J_)),
      interpolation_(interpolation),
      coarse_(coarse) {}

MultiVector TwoGrid::gather(const Eigen::VectorXd& at_all) const {
    MultiVector x(3 * std::ssize(free_), 1);
    for (std::size_t i = 0; i < free_.size(); ++i)
        x.col(0).segment<3>(3 * static_cast<Eigen::Index>(i)) = at_all.segment<3>(3 * Eigen::Index{free_[i]});
    return x;
}

Eigen::VectorXd TwoGrid::scatter(const MultiVector& x) const {
    Eigen::VectorXd at_all = Eigen::VectorXd::Zero(3 * interpolation_.rows());
    for (std::size_t i = 0; i < free_.size(); ++i)
        at_all.segment<3>(3 * Eigen::Index{free_[i]}) = x.col(0).segment<3>(3 * static_cast<Eigen::Index>(i));
    return at_all;
}

Eigen::VectorXd TwoGrid::estimate(const Eigen::VectorXd& r) const { return scatter(precondition(gather(r))); }

MultiVector TwoGrid::correct_on_coarse_grid(const MultiVector& residual) const {
    const Eigen::VectorXd at_all = scatter(residual);
    const Eigen::Map<const Points> fine(at_all.data(), interpolation_.rows(), 3);
    const Points gathered = interpolation_.transpose() * fine;
    const Eigen::VectorXd step = coarse_.solve(Eigen::Map<const Eigen::VectorXd>(gathered.data(), gathered.size()));
    const Points interpolated = interpolation_ * Eigen::Map<const Points>(step.data(), step.size() / 3, 3);
    return gather(Eigen::Map<const Eigen::VectorXd>(interpolated.data(), interpolated.size()));
}

/// Smooths, corrects, and smooths once more: symmetric, as conjugate gradients ask for.
MultiVector TwoGrid::precondition(const MultiVector& r) const {
    MultiVector x = MultiVector::Zero(r.rows(), 1), left = r;
    smoother_.smooth(rounded_, x, left, true);
    const MultiVector smooth = correct_on_coarse_grid(left);
    x += smooth;
    multiply(rounded_, smooth, left, Join::subtract);
    smoother_.smooth(rounded_, x, left, false);
    return x;
}

Eigen::VectorXd TwoGrid::solve(const Eigen::VectorXd& force, double tolerance) const {
    MultiVector r = gather(force), x = MultiVector::Zero(r.rows(), 1), z = precondition(r), p = z, Jp(r.rows(), 1);
    double rz = dots(r, z)(0);
    const double least = tolerance * tolerance * rz;
    for (int step = 0; step < most_steps && rz > least; ++step) {
        multiply(J_, p, Jp);
        const double curvature = dots(p, Jp)(0);
        if (!(curvature > 0)) break;
        const double along = rz / curvature;
        x += along * p;
        r -= along * Jp;
        z = precondition(r);
        const double next = dots(r, z)(0);
        p = z + next / rz * p;
        rz = next;
    }
    return scatter(x);
}

}  // namespace palpate::fem
