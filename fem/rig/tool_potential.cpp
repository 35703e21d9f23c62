#include "fem/rig/tool_potential.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <cmath>

#include "mesh/core/scaled_motion.h"
#include "mesh/errors.h"

namespace palpate::fem {

namespace {

// A contact of radius a gives way by F / (2 E* a) [Sneddon 1965], and a layer of stiffness k on it by F / (pi a^2 k):
// the share 2 E* / (pi a k). It is a thousandth for contacts of a tenth of the tool's radius, less for larger ones.
constexpr double added_compliance = 1e-3, least_contact = 0.1;
// A grip's force goes over in a layer of depth sqrt(E / k), k its stiffness per volume: a thousandth of its size.
constexpr double layer = 1e-3;
constexpr double bonds_within = 0.05;  // of the radius: what glue fills
// Of the radius, what a pressure of 5 E presses a tool in by. Beyond, on the way to an equilibrium, the shape's
// curvature makes tangents indefinite: with 0.01 a sphere pressed in by a radius took 102 factorisations, with this 27.
constexpr double barely_within = 5e-4;
constexpr double at_once = 0.25;  // of the radius: a tool that moves by more may come out at the other side

Mat3 rotation_by(const Vec3& w) {
    const double angle = w.norm();
    return angle == 0 ? Mat3::Identity().eval() : Eigen::AngleAxisd(angle, w / angle).toRotationMatrix();
}

Mat3 cross(const Vec3& v) { return (Mat3() << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0).finished(); }

}  // namespace

ToolPotential::ToolPotential(std::shared_ptr<const RigidTool> tool, const mesh::ToolMotion& motion, double young)
    : tool_(std::move(tool)),
      motion_(motion),
      young_(young),
      R_(rotation_by(motion.rotation)),
      origin_(tool_->tool.origin + motion.translation) {}

std::shared_ptr<const ToolPotential> ToolPotential::part_way(double share) const {
    return std::make_shared<ToolPotential>(tool_, mesh::scaled(motion_, share), young_);
}

double ToolPotential::reach() const { return !parts() ? INFINITY : at_once * tool_->shape->radius(); }

double ToolPotential::way() const {
    return motion_.translation.norm() + (tool_->shape ? tool_->shape->radius() * motion_.rotation.norm() : 0);
}

Eigen::VectorXd ToolPotential::weights(const Points& rest, const Eigen::VectorXd& even) const {
    if (is_grip()) return grip_weights(rest);
    const double k = young_ / (added_compliance * least_contact * tool_->shape->radius());
    if (parts()) return k * even;
    Eigen::VectorXd bonded = even;
    for (Eigen::Index i = 0; i < rest.rows(); ++i) {
        const double gap = tool_->shape->gap(rest.row(i)).value;
        if (std::abs(gap) > bonds_within * tool_->shape->radius()) bonded[i] = 0;
    }
    if (bonded.isZero(0))
        throw InvalidInput(
            fmt::format("The bonded tool \"{}\" touches no surface of the body at rest, where it would be bonded: "
                        "nothing lies within "
                        "a twentieth of its radius. Move it to the body, or call it frictionless.",
                        tool().name));
    return k * bonded;
}

/// All alike, as where nodes are held one by one.
Eigen::VectorXd ToolPotential::grip_weights(const Points& rest) const {
    const std::vector<char> held = mesh::contains(std::get<mesh::GripShape>(tool().shape).regions, rest);
    std::vector<Eigen::Index> in;
    for (Eigen::Index i = 0; i < rest.rows(); ++i)
        if (held[i]) in.push_back(i);
    if (in.empty())
        throw InvalidInput(fmt::format(
            "The regions of the grip \"{}\" hold no material of the body: move or widen them.", tool().name));
    const Points within = rest(in, Eigen::all);
    // A grip of one node, or of a few in one place, is stiff as one of this size over the body's.
    constexpr double least_size = 0.01;
    const double a =
        std::max(mesh::bounding_box(within).longest_side(), least_size * mesh::bounding_box(rest).longest_side());
    Eigen::VectorXd weights = Eigen::VectorXd::Zero(rest.rows());
    // k a^3 = E a / layer^2
    weights(in).setConstant(young_ * a / (layer * layer) / static_cast<double>(in.size()));
    return weights;
}

Gap ToolPotential::gap(const Vec3& X, const Vec3& x) const {
    const auto at_tool = [&](const Vec3& place) -> Vec3 { return R_.transpose() * (place - origin_) + tool().origin; };
    Gap gap = tool_->shape->gap(at_tool(x), at_tool(X));
    gap.normal = R_ * gap.normal;
    gap.hessian = R_ * gap.hessian * R_.transpose();
    return gap;
}

PointTerms ToolPotential::terms(const Vec3& X, const Vec3& x) const {
    if (!parts()) {
        const Vec3 away = x - origin_ - R_ * (X - tool().origin);
        return {.energy = away.squaredNorm() / 2, .gradient = away, .hessian = Mat3::Identity()};
    }
    const Gap at = gap(X, x);
    if (at.value >= 0) return {};
    // Far within, on the way to an equilibrium, the shape's curvature would only lead astray.
    const double bend = -at.value <= barely_within * tool_->shape->radius() ? at.value : 0;
    return {.energy = at.value * at.value / 2,
            .gradient = at.value * at.normal,
            .hessian = at.normal * at.normal.transpose() + bend * at.hessian};
}

PointOnTool::PointOnTool(const PointTerms& weighted, const Vec3& arm) {
    const Vec3& g = weighted.gradient;
    const Mat3 &H = weighted.hessian, r = cross(arm);
    wrench << -g, -arm.cross(g);
    by_pose << -H, H * r - cross(g);
    wrench_by_pose.topRows<3>() = -by_pose;
    wrench_by_pose.bottomRows<3>() = -r * by_pose;
    wrench_by_pose.bottomLeftCorner<3, 3>() -= cross(g);  // the origin moves under the arm
}

}  // namespace palpate::fem
