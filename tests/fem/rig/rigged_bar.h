#pragma once

#include "fem/rig/tool_potential.h"
#include "tests/fem/beam.h"

namespace palpate::fem {

inline std::shared_ptr<const RigidTool> sphere_tool(const Vec3& centre, double radius, bool bonded = false) {
    return std::make_shared<RigidTool>(
        mesh::Tool{.name = "ball", .shape = mesh::SphereShape{radius}, .bonded = bonded, .origin = centre});
}
inline std::shared_ptr<const RigidTool> flat_tool(const Vec3& centre, double radius, bool bonded = false) {
    return std::make_shared<RigidTool>(mesh::Tool{
        .name = "punch", .shape = mesh::FlatShape{radius, Vec3(0, 0, -1)}, .bonded = bonded, .origin = centre});
}
/// A box about a point.
inline std::shared_ptr<const RigidTool> box_tool(const Vec3& centre, const Vec3& half) {
    return std::make_shared<RigidTool>(
        mesh::Tool{.name = "block",
                   .shape = mesh::SurfaceShape{mesh::make_box(centre - half, centre + half, Eigen::Vector3i(2, 3, 2))},
                   .origin = centre});
}
/// The end of a bar, from x on.
inline std::shared_ptr<const RigidTool> grip_tool(double x, const Vec3& origin) {
    const Vec3 far = Vec3::Constant(1e3);
    return std::make_shared<RigidTool>(
        mesh::Tool{.name = "grip",
                   .shape = mesh::GripShape{{mesh::BoxRegion{Vec3(x, -far.y(), -far.z()), far}}},
                   .bonded = true,
                   .origin = origin});
}
inline std::shared_ptr<const ToolPotential> moved(const std::shared_ptr<const RigidTool>& tool, const Vec3& translation,
                                                  const Vec3& rotation, double young) {
    return std::make_shared<ToolPotential>(tool, mesh::ToolMotion{0, translation, rotation}, young);
}

/// A motion after a small step of the pose: three translations, then a turn about the moved origin.
inline mesh::ToolMotion stepped(const mesh::ToolMotion& motion, const Wrench& step) {
    const auto turn = [](const Vec3& w) {
        return w.norm() == 0 ? Mat3::Identity().eval() : Eigen::AngleAxisd(w.norm(), w.normalized()).toRotationMatrix();
    };
    const Eigen::AngleAxisd both(Mat3(turn(step.tail<3>()) * turn(motion.rotation)));
    return {motion.tool, motion.translation + step.head<3>(), both.angle() * both.axis()};
}

}  // namespace palpate::fem
