#include "identify/numerics/spectrum.h"

#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <algorithm>
#include <numeric>
#include <vector>

#include "identify/numerics/random.h"

namespace palpate::identify {
namespace {

constexpr int block = 8;  // columns that are multiplied at once, at least

/// An orthonormal basis of what the columns of X add to those of Q.
Eigen::MatrixXd beside(const Eigen::MatrixXd& Q, Eigen::MatrixXd X) {
    for (int twice = 0; twice < 2 && Q.cols() > 0; ++twice) X -= Q * (Q.transpose() * X);
    Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(X);
    qr.setThreshold(1e-8);
    Eigen::MatrixXd basis = qr.householderQ() * Eigen::MatrixXd::Identity(X.rows(), qr.rank());
    if (Q.cols() > 0) basis -= Q * (Q.transpose() * basis);
    return basis.colwise().normalized();
}

Spectrum above(double least, const Eigen::VectorXd& ascending, const Eigen::MatrixXd& vectors, bool is_whole = true) {
    const auto count = (ascending.array() >= least).count();
    return {ascending.tail(count).reverse(), vectors.rightCols(count).rowwise().reverse(), is_whole};
}

Eigen::MatrixXd random_columns(int P) {
    Eigen::MatrixXd columns(P, block);
    for (int i = 0; i < block; ++i) columns.col(i) = RandomStream(1, 0, i).normals(P);
    return columns;
}

}  // namespace

Eigen::MatrixXd Spectrum::inverse(double shift, const Eigen::MatrixXd& X) const {
    if (values.size() == 0) return X / shift;
    const Eigen::VectorXd share = values.array() / (shift + values.array());
    return (X - vectors * (share.asDiagonal() * (vectors.transpose() * X))) / shift;
}

Spectrum leading_spectrum(const SymmetricProduct& A, int P, const SpectrumOptions& options,
                          const Eigen::MatrixXd& start) {
    if (P <= options.exact) {
        const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> whole(A(Eigen::MatrixXd::Identity(P, P)));
        return above(0, whole.eigenvalues(), whole.eigenvectors());
    }

    const Eigen::Index begun = std::min<Eigen::Index>(start.cols(), options.largest);
    Eigen::MatrixXd Q = beside({}, begun > 0 ? Eigen::MatrixXd(start.leftCols(begun)) : random_columns(P)), AQ = A(Q);
    for (;;) {
        // Rayleigh and Ritz
        const Eigen::MatrixXd projected = Q.transpose() * AQ;
        const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> ritz((projected + projected.transpose()) / 2);
        const Eigen::MatrixXd& Y = ritz.eigenvectors();
        const Eigen::VectorXd& values = ritz.eigenvalues();
        const Eigen::MatrixXd left = AQ * Y - Q * (Y * values.asDiagonal());

        // found, when all that may lie above `least` are: an eigenvalue lies within the residual of each of Ritz's
        const Eigen::ArrayXd off = left.colwise().norm().transpose().array();
        const Eigen::ArrayXd allowed = options.residual * values.array().max(options.least);
        const bool found = (values.array() + off < options.least || off <= allowed).all();
        if (found || Q.cols() >= std::min(P, options.largest)) return above(options.least, values, Q * Y, found);

        // on from the worst
        std::vector<Eigen::Index> order(static_cast<std::size_t>(Q.cols()));
        std::iota(order.begin(), order.end(), 0);
        std::ranges::stable_sort(order, [&](auto a, auto b) { return off[a] / allowed[a] > off[b] / allowed[b]; });
        order.resize(std::min<std::size_t>(order.size(), std::max<std::size_t>(block, order.size() / 4)));
        const Eigen::MatrixXd more = beside(Q, left(Eigen::all, order));
        if (more.cols() == 0) return above(options.least, values, Q * Y);
        const Eigen::MatrixXd A_more = A(more);
        const auto before = Q.cols();
        Q.conservativeResize(Eigen::NoChange, before + more.cols());
        AQ.conservativeResize(Eigen::NoChange, before + more.cols());
        Q.rightCols(more.cols()) = more;
        AQ.rightCols(more.cols()) = A_more;
    }
}

}  // namespace palpate::identify
