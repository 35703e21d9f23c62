#include "skeleton/links/fibres/link_fibre.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include "mesh/errors.h"
#include "skeleton/model/turning_curvature.h"

namespace palpate::skeleton {

namespace {

constexpr int in_hexagon = 6;
// Radii of the hexagons, in radii of gyration.
const double outer = 2 * std::sqrt((3 + std::sqrt(3.0)) / 6), inner = 2 * std::sqrt((3 - std::sqrt(3.0)) / 6);

double angle_of(int fibre) {
    const double sixth = std::numbers::pi / 3;
    return fibre < in_hexagon ? fibre * sixth : (fibre - in_hexagon + 0.5) * sixth;
}

}  // namespace

double radius_of_gyration(const Link& link) {
    if (link.gyration > 0) return link.gyration;
    const double kE = link.stiffness[0], kF = link.stiffness[1];
    return kE > 0 ? std::sqrt(kF / (2 * kE)) : 0;
}

FibreOffsets fibre_offsets(const Link& link, const Vec3& direction) {
    Vec3 towards;  // the plane of flexion, or else the coordinate axis that the link is least along
    if (link.section) {
        towards = link.section->axes.row(1).transpose();
    } else {
        Eigen::Index axis = 0;
        direction.cwiseAbs().minCoeff(&axis);
        towards = Vec3::Unit(axis);
    }
    const Vec3 e = (towards - towards.dot(direction) * direction).normalized(), across = direction.cross(e);
    const double gyration = radius_of_gyration(link);
    FibreOffsets offsets;
    for (int j = 0; j < fibres_per_link; ++j) {
        const double r = gyration * (j < in_hexagon ? outer : inner), angle = angle_of(j);
        offsets[j] = r * (std::cos(angle) * e + std::sin(angle) * across);
    }
    return offsets;
}

FibreShares fibre_shares(const Link& link) {
    constexpr int elongation = 0, flexion = 1, flexion_2 = 3;
    FibreShares shares = FibreShares::Zero(fibres_per_link, link.stiffness.size());
    shares.col(elongation).setConstant(fibre_weight);
    const double gyration = radius_of_gyration(link);
    if (gyration == 0) return shares;
    // What the two kF have beyond kE r_g^2: their mean by weight that goes from the inner hexagon to the outer one,
    // their difference by cos 2 phi round the outer one. Without a second plane each has half of kF.
    const bool full = link.stiffness.size() > 3;
    const double square = gyration * gyration, part = full ? 1 : 0.5;
    for (int j = 0; j < fibres_per_link; ++j) {
        const bool is_outer = j < in_hexagon;
        const double mean = (is_outer ? 1 : -1) / (3 * square * (outer * outer - inner * inner));
        const double difference = is_outer ? std::cos(2 * angle_of(j)) / (1.5 * square * outer * outer) : 0;
        shares(j, elongation) -= mean * square;
        shares(j, flexion) += part * (mean + difference) / 2;
        shares(j, full ? flexion_2 : flexion) += part * (mean - difference) / 2;
    }
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
