#pragma once

#include "fem/large_deformation/node_integrals.h"
#include "fem/large_deformation/unknowns.h"

namespace palpate::fem {

/// What a body is, whatever it is made of.
struct BodyShape {
    mesh::VolumeMesh mesh;
    std::vector<char> held;
    Dilatation dilatation;
    std::vector<ElementShape> elements;
    NodeIntegrals integrals;

    NodeWeights points(ActsOn what, double density) const;
    /// Displacements of an element's nodes.
    NodeVectors displacements(const Eigen::VectorXd& u, std::size_t element) const;
    /// Adds forces on an element's nodes to those on all.
    void add(const NodeVectors& f, std::size_t element, Eigen::Ref<Eigen::VectorXd> forces) const;
};

/// The forces of one element on its nodes. @throws SolverFailure when it is inside out.
NodeVectors internal_force(const BodyShape& body, const ElementModel& model, const Eigen::VectorXd& u,
                           std::size_t element);

/// The potential at one displacement.
struct Potential {
    double value = 0;  // [N mm]
    double scale = 0;  // sum of its parts' amounts, which rounding is relative to [N mm]
};

/// A body of some material under effects and dead loads, a share of which is applied. Effects on the support hold the
/// body and are always there in full. The linear law takes effects as they are at rest, to second order.
class LoadedBody {
public:
    LoadedBody(const BodyShape& body, const BodySetting& setting, const Eigen::VectorXd& f, double share = 1);

    /// `net`: force on every node, minus the potential's gradient (3n). The value is infinite, and `net` not set, where
    /// an element is inside out.
    Potential potential(const Eigen::VectorXd& u, Eigen::VectorXd& net) const;
    /// Is no element inside out?
    bool admits(const Eigen::VectorXd& u) const;
    /// @throws SolverFailure where an element is inside out.
    Eigen::VectorXd net_force(const Eigen::VectorXd& u) const;
    /// About the norm of what rounding leaves of forces that balance [N].
    double rounding() const;
    /// Adds the potential's second derivative. @pre no element is inside out.
    void add_tangent(const Eigen::VectorXd& u, const Unknowns& unknowns, LowerMatrix& K) const;

private:
    struct Effect {
        const PointPotential* potential;
        NodeWeights at;
    };
    PointTerms terms(const Effect& effect, std::size_t k, const Eigen::VectorXd& u) const;  // at its point k

    const BodyShape& body_;
    ElementModel model_;
    std::vector<Effect> effects_;
    Eigen::VectorXd f_;
};

}  // namespace palpate::fem
