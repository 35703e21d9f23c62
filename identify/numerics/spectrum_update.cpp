#include "identify/numerics/spectrum_update.h"

#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>

namespace palpate::identify {

Spectrum added(const Spectrum& spectrum, const Eigen::MatrixXd& B, Eigen::Index most, double least) {
    const Eigen::Index r = spectrum.values.size(), k = B.cols();
    if (k == 0) return spectrum;

    // an orthonormal basis of both: V, and what B adds to it, projected twice against rounding
    Eigen::MatrixXd left = B;
    if (r > 0) {
        left -= spectrum.vectors * (spectrum.vectors.transpose() * left);
        left -= spectrum.vectors * (spectrum.vectors.transpose() * left);
    }
    const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(left);
    constexpr double rounding = 1e-10;  // of B, that is no direction of its own
    Eigen::Index own = 0;
    while (own < std::min({k, B.rows() - r}) && std::abs(qr.matrixR()(own, own)) > rounding * B.norm()) ++own;
    Eigen::MatrixXd basis(B.rows(), r + own);
    if (r > 0) basis.leftCols(r) = spectrum.vectors;
    basis.rightCols(own) = qr.householderQ() * Eigen::MatrixXd::Identity(B.rows(), own);

    // the sum in that basis
    const Eigen::MatrixXd along = basis.transpose() * B;
    Eigen::MatrixXd sum = along * along.transpose();
    sum.diagonal().head(r) += spectrum.values;
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(sum);
    const Eigen::Index kept = std::min<Eigen::Index>({most, B.rows(), (eigen.eigenvalues().array() >= least).count()});
    return {eigen.eigenvalues().tail(kept).reverse(),
            (basis * eigen.eigenvectors().rightCols(kept)).rowwise().reverse(), spectrum.is_whole};
}

}  // namespace palpate::identify
