#include "identify/models/marker_frames.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <Eigen/SVD>

#include "fem/interpolation/interpolation.h"
#include "skeleton/model/state.h"

namespace palpate::identify {
namespace {

using skeleton::skew;

/// The rotation R of F = R S, and S.
struct Polar {
    Mat3 R, S;
};

Polar polar(const Mat3& F) {
    const Eigen::JacobiSVD<Mat3> svd(F, Eigen::ComputeFullU | Eigen::ComputeFullV);
    const Mat3 V = svd.matrixV();
    Mat3 U = svd.matrixU();
    Vec3 s = svd.singularValues();
    if ((U * V.transpose()).determinant() < 0) {
        U.col(2) *= -1;
        s[2] *= -1;
    }
    return {U * V.transpose(), V * s.asDiagonal() * V.transpose()};
}

Eigen::Map<const Points> as_points(const Eigen::VectorXd& u) { return {u.data(), u.size() / 3, 3}; }

}  // namespace

MarkerFrames::MarkerFrames(const mesh::VolumeMesh& body, const std::vector<Marker>& markers) {
    const auto m = static_cast<Eigen::Index>(markers.size());
    rest_.resize(m, 3);
    Points anchors(m, 3);
    for (Eigen::Index i = 0; i < m; ++i) {
        rest_.row(i) = markers[i].rest;
        anchors.row(i) = markers[i].anchor.value_or(markers[i].rest);
    }
    offset_ = rest_ - anchors;
    N_ = fem::interpolation(body, anchors);
    if (offset_.isZero(0)) return;

    // The gradient as a central difference over a hundredth of the body, within a quadratic element almost exact.
    const double h = 0.01 * (body.nodes.colwise().maxCoeff() - body.nodes.colwise().minCoeff()).maxCoeff();
    for (int axis = 0; axis < 3; ++axis) {
        const Eigen::RowVector3d shift = h * Eigen::RowVector3d::Unit(axis);
        const Points ahead = anchors.rowwise() + shift, behind = anchors.rowwise() - shift;
        D_.emplace_back((fem::interpolation(body, ahead) - fem::interpolation(body, behind)) / (2 * h));
    }
}

Mat3 MarkerFrames::gradient(Eigen::Index marker, const Points& u) const {
    Mat3 H;
    for (int axis = 0; axis < 3; ++axis) H.col(axis) = (D_[axis].row(marker) * u).transpose();
    return H;
}

Points MarkerFrames::positions(const Eigen::VectorXd& u, bool small_strain) const {
    const Points nodal = as_points(u);
    Points x = rest_ + N_ * nodal;
    for (Eigen::Index i = 0; i < x.rows(); ++i) {
        if (offset_.row(i).isZero(0)) continue;
        const Mat3 H = gradient(i, nodal);
        const Mat3 turn =
            small_strain ? Mat3(0.5 * (H - H.transpose())) : Mat3(polar(Mat3::Identity() + H).R - Mat3::Identity());
        x.row(i) += (turn * offset_.row(i).transpose()).transpose();
    }
    return x;
}

Eigen::SparseMatrix<double> MarkerFrames::derivative(const Eigen::VectorXd& u, bool small_strain) const {
    const Points nodal = as_points(u);
    std::vector<Eigen::Triplet<double>> entries;
    for (Eigen::Index i = 0; i < rest_.rows(); ++i) {
        for (Eigen::SparseMatrix<double, Eigen::RowMajor>::InnerIterator it(N_, i); it; ++it) {
            for (int c = 0; c < 3; ++c) entries.emplace_back(3 * i + c, 3 * it.col() + c, it.value());
        }
        if (offset_.row(i).isZero(0)) continue;

        // d(R o) = R [w] o = -R [o] w with (tr(S) - S) w = vee(R^T dF - dF^T R)
        const Polar at =
            small_strain ? Polar{Mat3::Identity(), Mat3::Identity()} : polar(Mat3::Identity() + gradient(i, nodal));
        const Mat3 to_turn =
            -at.R * skew(offset_.row(i).transpose()) * (at.S.trace() * Mat3::Identity() - at.S).inverse();
        for (int axis = 0; axis < 3; ++axis) {
            for (Eigen::SparseMatrix<double, Eigen::RowMajor>::InnerIterator it(D_[axis], i); it; ++it) {
                for (int c = 0; c < 3; ++c) {
                    // dF has the one entry (c, axis): R^T dF is row c of R, as a column, in column `axis`
                    Mat3 A = Mat3::Zero();
                    A.col(axis) = at.R.row(c).transpose();
                    const Vec3 vee(A(2, 1) - A(1, 2), A(0, 2) - A(2, 0), A(1, 0) - A(0, 1));
                    const Vec3 moved = it.value() * (to_turn * vee);
                    for (int a = 0; a < 3; ++a) entries.emplace_back(3 * i + a, 3 * it.col() + c, moved[a]);
                }
            }
        }
    }
    Eigen::SparseMatrix<double> P(3 * rest_.rows(), u.size());
    P.setFromTriplets(entries.begin(), entries.end());
    return P;
}

}  // namespace palpate::identify
