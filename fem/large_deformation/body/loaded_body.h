#pragma once

#include "fem/large_deformation/body/body_material.h"
#include "fem/large_deformation/body/node_weights.h"
#include "fem/large_deformation/body/unknowns.h"
#include "fem/large_deformation/loads/placed_tendon.h"
#include "fem/large_deformation/loads/placed_tool.h"

namespace palpate::fem {

/// The potential at one displacement.
struct Potential {
    double value = 0;  // [N mm]
    double scale = 0;  // sum of its parts' amounts, which rounding is relative to [N mm]
    double grip = 0;   // norm of the forces by which tools and tendons of a given length hold the body [N]
};

/// A body of some material under effects and dead loads, a share of which is applied: a tool has made that share of its
/// motion. Effects on the support hold the body and are always there in full. The linear law takes effects as they are
/// at rest, to second order, but for those that act on one side only, and tools.
class LoadedBody {
public:
    /// `before`, `flows`: as BodyMaterial takes them. @pre body, setting and `before` outlive it.
    LoadedBody(const BodyShape& body, const BodySetting& setting, const Eigen::VectorXd& f,
               const MaterialState* before = nullptr, double share = 1, bool flows = true);

    /// Are its forces the gradient of a potential?
    bool conservative() const { return material_.conservative(); }

    /// `net`: force on every node, minus the potential's gradient (3n). The value is infinite, and `net` not set, where
    /// an element is inside out.
    Potential potential(const Eigen::VectorXd& u, Eigen::VectorXd& net) const;
    /// Forces of tools on the nodes, and of tendons that are of a given length (3n) [N]: they are proportional to the
    /// body's stiffness.
    Eigen::VectorXd grip(const Eigen::VectorXd& u) const;
    /// May a tool touch the body, and part from it?
    bool may_part() const;
    /// Points in reach of such tools.
    std::vector<NearPoint> near_points(const Eigen::VectorXd& u) const;
    /// By how much a point's gap grows with a step u, and the forces on the nodes that a unit force along its normal
    /// is, added `times` over to `sum` (3n).
    double opening(const NearPoint& point, const Eigen::VectorXd& u) const;
    void add_push(const NearPoint& point, double times, Eigen::VectorXd& sum) const;
    /// Adds the second derivative of a point's touch by its normal, `times` over.
    void add_touch(const NearPoint& point, double times, const Unknowns& unknowns, LowerMatrix& K) const;
    /// Is no element inside out?
    bool admits(const Eigen::VectorXd& u) const;
    /// @throws SolverFailure where an element is inside out.
    Eigen::VectorXd net_force(const Eigen::VectorXd& u) const;
    /// About the norm of what rounding leaves of forces that balance in the displacement u [N].
    double rounding(const Eigen::VectorXd& u) const;
    /// Adds the potential's second derivative. @pre no element is inside out.
    void add_tangent(const Eigen::VectorXd& u, const Unknowns& unknowns, LowerMatrix& K) const;

private:
    struct PlacedPotential {
        const PointPotential* potential;
        NodeWeights at;
    };
    PointTerms terms(const PlacedPotential& effect, std::size_t k, const Eigen::VectorXd& u) const;  // at its point k

    const BodyShape& body_;
    BodyMaterial material_;
    std::vector<PlacedPotential> effects_;
    const SurfaceEnergies& surface_;
    double share_;
    Eigen::VectorXd f_;
    Eigen::VectorXd pressures_;  // in each cavity [MPa]
    std::vector<PlacedTool> tools_;
    std::vector<PlacedTendon> tendons_;
};

}  // namespace palpate::fem
