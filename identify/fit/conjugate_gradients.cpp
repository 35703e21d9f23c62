#include "identify/fit/conjugate_gradients.h"

namespace palpate::identify {

ShiftedSolution solve_shifted(const SymmetricProduct& A, double shift, const Eigen::MatrixXd& B, const Spectrum& near,
                              const ConjugateGradients& options) {
    using Row = Eigen::RowVectorXd;
    ShiftedSolution solution{Eigen::MatrixXd::Zero(B.rows(), B.cols()), B};
    Eigen::MatrixXd& R = solution.left;
    const Row enough = options.residual * B.colwise().norm();
    Eigen::MatrixXd Z = near.inverse(shift, R), directions = Z;
    Row rz = R.cwiseProduct(Z).colwise().sum();
    while (solution.products < options.products && (R.colwise().norm().array() > enough.array()).any()) {
        const Eigen::MatrixXd Q = A(directions) + shift * directions;
        ++solution.products;
        // a column that is solved already has no way to go
        const Row bends = directions.cwiseProduct(Q).colwise().sum();
        const Row lengths = (bends.array() > 0).select(rz.array() / bends.array(), 0);
        solution.X += directions * lengths.asDiagonal();
        R -= Q * lengths.asDiagonal();
        Z = near.inverse(shift, R);
        const Row next = R.cwiseProduct(Z).colwise().sum();
        const Row ratios = (rz.array() > 0).select(next.array() / rz.array(), 0);
        directions = Z + directions * ratios.asDiagonal();
        rz = next;
    }
    return solution;
}

}  // namespace palpate::identify
