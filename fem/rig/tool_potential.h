#pragma once

#include <memory>

#include "fem/effects/point/point_potential.h"
#include "fem/rig/tool_shape.h"

namespace palpate::fem {

/// A tool as bodies feel it, made once for all its poses.
struct RigidTool {
    /// @throws InvalidInput as tool_shape.
    explicit RigidTool(mesh::Tool the_tool) : tool(std::move(the_tool)), shape(tool_shape(tool)) {}
    mesh::Tool tool;
    std::shared_ptr<const RigidShape> shape;  // null: a grip
};

/// What a tool in some pose does to the points of a body, as a potential:
///   free of friction, on the surface     e = min(0, gap(x))^2 / 2
///   bonded                               e = |x - y(X)|^2 / 2, y(X) where a rigid motion takes the point's place
/// The weights [N/mm] are stiffness, a share of the body's: so the compliance that a tool adds stays as small a share
/// of the contact's own in every body, and with no force but those of tools the shape that a body takes does not
/// depend on its stiffness, as it should. What a shape is bonded to is what lies within a twentieth of its radius at
/// rest; a grip holds what lies in its regions.
class ToolPotential : public PointPotential {
public:
    /// `motion`: no coordinate free. `young`: of the body [MPa].
    ToolPotential(std::shared_ptr<const RigidTool> tool, const mesh::ToolMotion& motion, double young);

    const mesh::Tool& tool() const { return tool_->tool; }
    const mesh::ToolMotion& motion() const { return motion_; }
    double young() const { return young_; }         // of the body [MPa]
    const Vec3& origin() const { return origin_; }  // where it has moved to [mm]
    bool is_grip() const { return !tool_->shape; }
    /// On the way there from rest: with a share of the motion.
    virtual std::shared_ptr<const ToolPotential> part_way(double share) const;
    /// May it part from the body?
    bool parts() const { return !tool().bonded && !is_grip(); }
    /// About how far it may move at once and still meet the side of the body that it is on [mm]; infinite when bonded.
    double reach() const;
    /// How far the motion takes its points from rest [mm].
    virtual double way() const;

    /// Of a point X of the body that stands at x, where the tool is now, derivatives by x. @pre it is no grip.
    Gap gap(const Vec3& X, const Vec3& x) const;

    ActsOn acts_on() const override { return is_grip() ? ActsOn::material : ActsOn::surface; }
    /// @throws InvalidInput when it is bonded to nothing.
    Eigen::VectorXd weights(const Points& rest, const Eigen::VectorXd& even) const override;
    PointTerms terms(const Vec3& X, const Vec3& x) const override;
    /// It is taken as it stands by every law.
    bool is_one_sided() const override { return true; }

private:
    Eigen::VectorXd grip_weights(const Points& rest) const;

    std::shared_ptr<const RigidTool> tool_;
    mesh::ToolMotion motion_;
    double young_;
    Mat3 R_;
    Vec3 origin_;
};

using ToolPotentials = std::vector<std::shared_ptr<const ToolPotential>>;

/// Force of a tool on a body and moment about the tool's moved origin, by virtual work [N, N mm].
using Wrench = Eigen::Matrix<double, 6, 1>;

/// A point's part in the energy Pi(x, z) of a tool in the pose z, by steps of which the origin moves and the tool turns
/// about it, rotation vectors in space:
///   dPi/dz = (-g, -r x g): the force and moment on the body, r = x - origin
///   d^2 Pi / dx dz = (-H, H [r] - [g])
///   d^2 Pi / dz dz = of these by z
struct PointOnTool {
    /// `weighted`: the terms times the point's weight.
    PointOnTool(const PointTerms& weighted, const Vec3& arm);
    Wrench wrench;
    Eigen::Matrix<double, 3, 6> by_pose;  // of the gradient by x
    Eigen::Matrix<double, 6, 6> wrench_by_pose;
};

}  // namespace palpate::fem
