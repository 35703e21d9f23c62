#include "skeleton/links/full_link.h"

#include <Eigen/Geometry>
#include <array>

#include "skeleton/model/turning_curvature.h"

namespace palpate::skeleton {

namespace {

// The axis of each parting of the ends, and of each of their turns, by its place in Stiffness.
struct Part {
    Stiffness kind;
    int axis;
};
constexpr std::array<Part, 3> partings{{{Stiffness::elongation, 0}, {Stiffness::shear, 1}, {Stiffness::shear_2, 2}}};
constexpr std::array<Part, 3> turnings{{{Stiffness::torsion, 0}, {Stiffness::flexion, 2}, {Stiffness::flexion_2, 1}}};

void add_symmetric(const Mat3& B, int row, int column, Mat12& H) {
    H.block<3, 3>(row, column) += B;
    H.block<3, 3>(column, row) += B.transpose();
}

}  // namespace

FullLink::FullLink(const LinkSection& section, double length, const Vec3& X_a, const Vec3& X_b, const Vec3& x_a,
                   const Mat3& R_a, const Vec3& x_b, const Mat3& R_b)
    : arm_a_(R_a * (section.at - X_a)),
      arm_b_(R_b * (section.at - X_b)),
      gap_((x_b - x_a) + (arm_b_ - arm_a_)),
      axes_a_(R_a * section.axes.transpose()),
      axes_b_(R_b * section.axes.transpose()) {
    // A step turns a half's axis f to f + w x f and its arm r to r + w x r.
    for (const auto& [kind, axis] : partings) {
        const Vec3 f_a = axes_a_.col(axis), f_b = axes_b_.col(axis), mean = 0.5 * (f_a + f_b);
        const auto s = static_cast<int>(kind);
        strains_[s] = mean.dot(gap_) - section.natural[s];
        gradients_.col(s) << -mean, 0.5 * f_a.cross(gap_) - arm_a_.cross(mean), mean,
            0.5 * f_b.cross(gap_) + arm_b_.cross(mean);
    }
    strains_[0] -= length - (X_b - X_a).norm();

    // It takes (w, v) to g (w, v), g = (1 - |m|^2 / 8, m / 2 - w_a x w_b / 4) + O(3) with m = w_b - w_a, and R_a f with
    // it: v . R_a f changes by m . y / 2 - |m|^2 v . R_a f / 8 - (w_a x w_b) . y / 4, y = w R_a f + v x R_a f.
    Eigen::Quaterniond turn(Mat3(R_b * R_a.transpose()));
    if (turn.w() < 0) turn.coeffs() = -turn.coeffs();
    for (const auto& [kind, axis] : turnings) {
        const Vec3 f = axes_a_.col(axis);
        const auto s = static_cast<int>(kind);
        halves_[axis] = turn.vec().dot(f);
        turns_.col(axis) = turn.w() * f + turn.vec().cross(f);
        strains_[s] = 2 * halves_[axis] - section.natural[s];
        gradients_.col(s) << Vec3::Zero(), -turns_.col(axis), Vec3::Zero(), turns_.col(axis);
    }
}

void FullLink::couple(const Eigen::Matrix<double, 6, 6>& C) {
    coupling_ = C;
    strains_ = C.triangularView<Eigen::UnitUpper>() * strains_;
    gradients_ = (gradients_ * C.transpose()).eval();
}

void FullLink::add_curvature(const Strains& of_coupled, Mat12& H) const {
    const Strains factors = coupling_ ? Strains(coupling_->transpose() * of_coupled) : of_coupled;
    // All is linear in the axes.
    Vec3 f_a = Vec3::Zero(), f_b = Vec3::Zero();
    for (const auto& [kind, axis] : partings) {
        f_a += factors[static_cast<int>(kind)] * axes_a_.col(axis);
        f_b += factors[static_cast<int>(kind)] * axes_b_.col(axis);
    }
    const Vec3 mean = 0.5 * (f_a + f_b);
    const Mat3 by_a = 0.5 * skew(f_a), by_b = 0.5 * skew(f_b);
    add_symmetric(by_a, w_a, dx_b, H);
    add_symmetric(-by_a, w_a, dx_a, H);
    add_symmetric(by_b, w_b, dx_b, H);
    add_symmetric(-by_b, w_b, dx_a, H);
    // Axis and arm of a half turn together, (w x f) . (w x r) = |w|^2 f . r - (w . f) (w . r), and each by itself.
    H.block<3, 3>(w_a, w_a) +=
        turning_curvature(f_a, arm_a_) - turning_curvature(mean, arm_a_) + 0.5 * turning_curvature(f_a, gap_);
    H.block<3, 3>(w_b, w_b) +=
        turning_curvature(mean, arm_b_) - turning_curvature(f_b, arm_b_) + 0.5 * turning_curvature(f_b, gap_);
    Mat3 both = f_b * arm_a_.transpose() - arm_b_ * f_a.transpose();
    both.diagonal().array() += f_a.dot(arm_b_) - f_b.dot(arm_a_);
    both *= 0.5;

    double half = 0;
    Vec3 turn = Vec3::Zero();
    for (const auto& [kind, axis] : turnings) {
        half += factors[static_cast<int>(kind)] * halves_[axis];
        turn += factors[static_cast<int>(kind)] * turns_.col(axis);
    }
    both += 0.5 * skew(turn);
    both.diagonal().array() += 0.5 * half;
    H.block<3, 3>(w_a, w_a).diagonal().array() -= 0.5 * half;
    H.block<3, 3>(w_b, w_b).diagonal().array() -= 0.5 * half;
    add_symmetric(both, w_a, w_b, H);
}

void FullLink::add_hessian(const Strains& k, Mat12& H) const {
    H.noalias() += gradients_ * k.asDiagonal() * gradients_.transpose();
    add_curvature(k.cwiseProduct(strains_), H);
}

FullLink full_link(const Link& link, const State& rest, const LinkPose& ends) {
    return {
        *link.section, link.length, rest.x.row(link.a).transpose(), rest.x.row(link.b).transpose(), ends.x_a, ends.R_a,
        ends.x_b,      ends.R_b};
}

LinkTerms full_link_terms(const FullLink& link, bool with_hessian) {
    LinkTerms terms;
    terms.energy = 0.5 * link.strains().cwiseAbs2();
    terms.gradient = link.gradients() * link.strains().asDiagonal();
    if (with_hessian) {
        for (int s = 0; s < 6; ++s) {
            terms.hessian[s].setZero();
            link.add_hessian(FullLink::Strains::Unit(s), terms.hessian[s]);
        }
    }
    return terms;
}

}  // namespace palpate::skeleton
