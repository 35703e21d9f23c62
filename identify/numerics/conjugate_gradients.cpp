#include "identify/numerics/conjugate_gradients.h"

#include <Eigen/Cholesky>
#include <Eigen/QR>
#include <algorithm>
#include <limits>
#include <vector>

namespace palpate::identify {
namespace {

using Row = Eigen::RowVectorXd;

constexpr double dependent = 1e-10;    // of a column of length 1, beside the others
constexpr std::size_t least_back = 3;  // products whose gains tell what is left
constexpr std::size_t share_back = 4;  // or such a part of all, the more the slower they come

/// An orthonormal basis of these columns, however different their lengths.
Eigen::MatrixXd basis_of(const Eigen::MatrixXd& X) {
    const Eigen::RowVectorXd lengths = X.colwise().norm();
    const Eigen::MatrixXd alike = X * (lengths.array() > 0).select(lengths.cwiseInverse(), 0).asDiagonal();
    Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(alike);
    qr.setThreshold(dependent);
    return qr.householderQ() * Eigen::MatrixXd::Identity(X.rows(), qr.rank());
}

/// What a column has left to gain: as much as it did last, or more, if gains go on to fall as they did; infinite where
/// they did not fall.
double left_to_gain(const std::vector<Row>& gains, Eigen::Index column) {
    const std::size_t back = std::max(least_back, gains.size() / share_back);
    if (gains.size() < 2 * back) return std::numeric_limits<double>::infinity();
    double last = 0, before = 0;
    for (std::size_t i = gains.size() - back; i < gains.size(); ++i) {
        last += gains[i][column];
        before += gains[i - back][column];
    }
    if (last == 0) return 0;
    return last < before ? last * std::max(1.0, last / (before - last)) : std::numeric_limits<double>::infinity();
}

}  // namespace

ShiftedSolution solve_shifted(const SymmetricProduct& A, double shift, const Eigen::MatrixXd& B, const Spectrum& near,
                              const ConjugateGradients& options) {
    ShiftedSolution solution{Eigen::MatrixXd::Zero(B.rows(), B.cols()), B};
    Eigen::MatrixXd& R = solution.left;
    Eigen::MatrixXd Z = near.inverse(shift, R), directions = basis_of(Z);
    Row energies = Row::Zero(B.cols());  // so far
    std::vector<Row> gains;              // of each product
    const auto is_solved = [&] {
        for (Eigen::Index i = 0; i < B.cols(); ++i) {
            const double allowed = std::max(options.left * energies[i], options.enough);
            if (R.col(i).dot(Z.col(i)) > allowed && left_to_gain(gains, i) > allowed) return false;
        }
        return true;
    };
    while (directions.cols() > 0 && solution.products < options.products) {
        const Eigen::MatrixXd Q = A(directions) + shift * directions;
        ++solution.products;
        const Eigen::LLT<Eigen::MatrixXd> bends(directions.transpose() * Q);
        if (bends.info() != Eigen::Success) break;  // eigenvalues so large that the shift drowns
        const Eigen::MatrixXd falls = directions.transpose() * R, lengths = bends.solve(falls);
        solution.X += directions * lengths;
        R -= Q * lengths;
        gains.emplace_back(falls.cwiseProduct(lengths).colwise().sum());
        energies += gains.back();
        Z = near.inverse(shift, R);
        if (is_solved()) break;
        directions = basis_of(Z - directions * bends.solve(Q.transpose() * Z));
    }
    return solution;
}

}  // namespace palpate::identify
