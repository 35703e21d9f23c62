#pragma once

#include "fem/large_deformation/body/body_shape.h"
#include "fem/rig/tool_potential.h"

namespace palpate::fem {

/// A point of a body's surface near a tool that it may touch.
struct NearPoint {
    int id = 0;            // among all points of all tools, the same in every displacement
    double gap = 0;        // below 0: it is in touch [mm]
    Vec3 normal;           // d gap / d x
    double stiffness = 0;  // of the touch [N/mm]
    const Carrier* at = nullptr;
};

/// A tool in some pose on a body of finite elements: the points that it may touch, or holds.
class PlacedTool {
public:
    /// @pre the body outlives it. @throws InvalidInput as ToolPotential::weights.
    PlacedTool(const BodyShape& body, std::shared_ptr<const ToolPotential> potential);

    /// Pi [N mm]; adds `factor` dPi/du to `sum` (3n).
    double add_gradient(const Eigen::VectorXd& u, double factor, Eigen::VectorXd& sum) const;
    /// Adds d^2 Pi / du^2.
    void add_hessian(const Eigen::VectorXd& u, const Unknowns& unknowns, LowerMatrix& K) const;

    bool parts() const { return potential_->parts(); }
    /// Adds the points that it may touch and that are in its reach, numbered from `first`; the number after the last
    /// of all its points.
    int add_near_points(const Eigen::VectorXd& u, int first, std::vector<NearPoint>& points) const;

    /// About the norm of what rounding of positions leaves of its forces [N].
    double rounding() const;

    Wrench wrench(const Eigen::VectorXd& u) const;
    /// d^2 Pi / du dz (3n x 6), z the pose's steps: what PointOnTool has at each point.
    Eigen::MatrixXd by_pose(const Eigen::VectorXd& u) const;
    Eigen::Matrix<double, 6, 6> wrench_by_pose(const Eigen::VectorXd& u) const;

private:
    /// Calls visit(k, where point k stands, its terms times its weight) for points that feel the tool.
    template <class Visit>
    void for_each_point(const Eigen::VectorXd& u, const Visit& visit) const;

    const BodyShape& body_;
    std::shared_ptr<const ToolPotential> potential_;
    const BodyPoints& points_;
    std::vector<int> chosen_;      // of the points, those with a weight
    std::vector<double> weights_;  // their stiffness [N/mm]
};

}  // namespace palpate::fem
