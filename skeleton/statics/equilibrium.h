#pragma once

#include <Eigen/SparseCore>
#include <functional>
#include <memory>
#include <vector>

#include "skeleton/links/fibres/plastic_fibre.h"
#include "skeleton/loads/load.h"
#include "skeleton/model/observation.h"

namespace palpate::skeleton {

/// J^-1 B (6N x p) of an equilibrium nearby.
using NearbyTangent = std::function<Eigen::MatrixXd(const Eigen::MatrixXd& B)>;

struct EquilibriumOptions {
    double tolerance = 1e-9;  // of the residual, as a share of the largest force of loads and effects, > 0
    int iterations = 200;     // Newton steps at one load, >= 1
    NearbyTangent nearby{};   // serves as long as steps by it converge well; large rotations alone
    void validate() const;    // @throws InvalidInput naming option, value and bound
};

struct Equilibrium {
    State state;  // law linear: rest advanced by the step, for pictures only
    int iterations = 0;
    double residual = 0;   // largest force left [N], torques over the mean link length
    Eigen::VectorXd step;  // from rest (6N); law linear: the answer itself, linear in the load
    FibreStates before{};  // what the links' fibres had been through in the states before (12L); empty: nothing
};

/// The configuration in which all net forces vanish, by the model's law: one linear step from rest, or Newton on the
/// potential, globalised so that it ends in a stable equilibrium; load stepping when it fails at once. The model's
/// effects are in force; the linear law takes them as they are at rest, to first order.
/// `start`: a neighbouring state, rest by default. `before`: what a material that remembers had been through.
/// @throws SolverFailure with iterations and residual when none was found, or naming an unconstrained sphere;
/// InvalidInput when no sphere is held or some hang on no held one.
Equilibrium equilibrium(const Model& model, const Load& load, const EquilibriumOptions& options = {},
                        const State* start = nullptr, const FibreStates& before = {});

/// What the fibres of the links have been through after an equilibrium, `before` the next one (12L). The linear law
/// takes the material as it is at rest: in it nothing flows or softens. Empty when nothing remembers. `extra`, here and
/// below: effects in force beyond the model's own.
FibreStates flowed(const Model& model, const Equilibrium& equilibrium, const fem::Effects& extra = {});

/// Positions of attached points in an equilibrium, by the model's law (m x 3) [mm]: linear in the step for the
/// linear law, as they are for the other.
Points observe(const Model& model, const Equilibrium& equilibrium, const std::vector<Attachment>& points);

/// The same under the load that made the equilibrium: with the dents that it presses.
Points observed(const Model& model, const Equilibrium& equilibrium, const Load& load,
                const std::vector<Attachment>& points);

/// P = d observe / d step in an equilibrium, by the model's law (3m x 6N).
Eigen::SparseMatrix<double> observation_jacobian(const Model& model, const Equilibrium& equilibrium,
                                                 const std::vector<Attachment>& points);

/// Force signatures in an equilibrium, by the model's law (6N x stiffnesses): d residual / d stiffness, effects in the
/// links included. With P and the tangent's inverse, d observe / d k = P J^-1 link_forces.
Eigen::SparseMatrix<double> link_forces(const Model& model, const Equilibrium& equilibrium,
                                        const fem::Effects& extra = {});

/// Solves for equilibria of one model again and again, with other stiffnesses k (as stiffness_vector orders them) and
/// loads: keeps ordering, symbolic factorisation and work space. Not for several threads at once: one each.
class StaticsSolver {
public:
    /// Keeps what it needs of the model. `extra`: effects in force beyond the model's own.
    /// @throws InvalidInput when no sphere is held or some hang on no held one, or as physics_of.
    explicit StaticsSolver(const Model& model, const fem::Effects& extra = {});
    ~StaticsSolver();
    StaticsSolver(StaticsSolver&&) noexcept;
    StaticsSolver& operator=(StaticsSolver&&) noexcept;

    /// Loads that will come. The order of elimination, and with it the rounding of every answer, then no longer
    /// depends on which of them came first.
    void expect(const std::vector<Load>& loads);

    /// As the free function, which wraps it; leaves the tangent factored, as factor_tangent does. `start` matters to
    /// the large-rotation law only.
    Equilibrium solve(const Eigen::VectorXd& k, const Load& load, const EquilibriumOptions& options = {},
                      const State* start = nullptr, const FibreStates& before = {});
    Equilibrium solve(const Eigen::VectorXd& k, const Load& load, const EquilibriumOptions& options,
                      const Equilibrium* start) {
        return solve(k, load, options, start ? &start->state : nullptr);
    }

    /// Linear steps from rest (6N x p) under generalized forces F (6N x p): one factorisation, whatever the law. The
    /// effects' stiffness at rest takes part, their forces there are for F to tell, those in the links as well.
    Eigen::MatrixXd linear_steps(const Eigen::VectorXd& k, const Eigen::MatrixXd& F);

    /// Factors the tangent J in an equilibrium, by the model's law (linear: at rest). @throws SolverFailure when it
    /// is not positive definite.
    void factor_tangent(const Eigen::VectorXd& k, const Load& load, const Equilibrium& equilibrium);

    /// J^-1 B (6N x p) with the tangent of the last solve, linear_steps or factor_tangent; rows of held spheres are
    /// ignored in B and zero in the result, unless an effect releases them.
    Eigen::MatrixXd solve_tangent(const Eigen::MatrixXd& B) const;

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace palpate::skeleton
