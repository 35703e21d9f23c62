#include "skeleton/links/link_fibre.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <cmath>

#include "mesh/errors.h"
#include "skeleton/links/turning_curvature.h"

namespace palpate::skeleton {

namespace {

const double ring_in_gyrations = std::sqrt(8.0 / 3);

}  // namespace

double radius_of_gyration(const Link& link) {
    if (link.gyration > 0) return link.gyration;
    const double kE = link.stiffness[0], kF = link.stiffness[1];
    return kE > 0 ? std::sqrt(kF / (2 * kE)) : 0;
}

FibreOffsets fibre_offsets(const Link& link, const Vec3& direction) {
    // Two of the six lie in the plane of flexion, or towards the coordinate axis that the link is least along.
    Vec3 towards;
    if (link.section) {
        towards = link.section->axes.row(1).transpose();
    } else {
        Eigen::Index axis = 0;
        direction.cwiseAbs().minCoeff(&axis);
        towards = Vec3::Unit(axis);
    }
    const Vec3 e = (towards - towards.dot(direction) * direction).normalized();
    const double r = ring_in_gyrations * radius_of_gyration(link);
    const Vec3 x = r * e, y = r * std::sqrt(0.75) * direction.cross(e);
    return {Vec3::Zero(), x, 0.5 * x + y, -0.5 * x + y, -x, -0.5 * x - y, 0.5 * x - y};
}

FibreShares fibre_shares(const Link& link) {
    constexpr int elongation = 0, flexion = 1, flexion_2 = 3;
    FibreShares shares = FibreShares::Zero(fibres_per_link, link.stiffness.size());
    shares(0, elongation) = 1;
    const double r = ring_in_gyrations * radius_of_gyration(link);
    if (r == 0) return shares;
    // With A = kF / r^2 of the two planes, the two fibres in the first have A_1 / 2 - A_2 / 6 each, the four others
    // A_2 / 3, and the one on the axis what is left. Without a second plane each takes half of kF.
    const bool full = link.stiffness.size() > 3;
    const double by = (full ? 1 : 0.5) / (r * r);
    const int second = full ? flexion_2 : flexion;
    for (int j = 1; j < fibres_per_link; ++j) {
        const bool in_first = j == 1 || j == 4;
        if (in_first) shares(j, flexion) += by / 2;
        shares(j, second) += in_first ? -by / 6 : by / 3;
    }
    shares(0, flexion) -= by;
    shares(0, second) -= by;
    return shares;
}

LinkFibre::LinkFibre(double length, const Vec3& offset, const Vec3& x_a, const Mat3& R_a, const Vec3& x_b,
                     const Mat3& R_b)
    : length_(length), arm_a_(R_a * offset), arm_b_(R_b * offset) {
    const Vec3 d = (x_b - x_a) + (arm_b_ - arm_a_);
    l_ = d.norm();
    if (!(l_ > 1e-9 * length))
        throw SolverFailure(
            fmt::format("a side of a link of rest length {:.6g} mm was pressed to nothing; "
                        "a smaller load or a stiffer link would keep it apart",
                        length));
    along_ = d / l_;
}

// With d = x_b + R_b r - x_a - R_a r, l = |d| and u = d / l: dl = u . J step, J = [-I, [R_a r], I, -[R_b r]].
void LinkFibre::add_gradient(const StretchTerms& terms, Eigen::Ref<Vec12> g) const {
    const Vec3 pull = (terms.first / length_) * along_;
    g.segment<3>(0) -= pull;
    g.segment<3>(3) -= arm_a_.cross(pull);
    g.segment<3>(6) += pull;
    g.segment<3>(9) += arm_b_.cross(pull);
}

// l_ij = J^T (I - u u^T) J / l, and u along the arms' turning.
void LinkFibre::add_hessian(const StretchTerms& terms, Mat12& H) const {
    const double across = terms.first / (length_ * l_);
    const Mat3 A =
        (terms.second / (length_ * length_) - across) * along_ * along_.transpose() + across * Mat3::Identity();
    Eigen::Matrix<double, 3, 12> J;
    J << -Mat3::Identity(), skew(arm_a_), Mat3::Identity(), -skew(arm_b_);
    H += J.transpose() * A * J;
    const Vec3 pull = (terms.first / length_) * along_;
    H.block<3, 3>(3, 3) -= turning_curvature(pull, arm_a_);
    H.block<3, 3>(9, 9) += turning_curvature(pull, arm_b_);
}

}  // namespace palpate::skeleton
