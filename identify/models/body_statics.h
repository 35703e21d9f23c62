#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "fem/effects/effects.h"
#include "mesh/core/actuator.h"
#include "mesh/core/contact.h"
#include "mesh/core/tool.h"
#include "mesh/types.h"

namespace palpate::identify {

/// A number behind a model's stiffness, as a logarithm, and what is believed of it before the measurements.
struct StiffnessParameter {
    std::string name;
    double start = 0;
    double prior_mean = 0, prior_sd = 1;
    bool stiffens = true;  // all such parameters raised by ln c make the body c times as stiff
    double least = -INFINITY, most = INFINITY;
};

/// Settings of a model evaluation.
struct ModelSetting {
    int law = 0;            // index in BodyModel::laws
    Eigen::VectorXd theta;  // stiffness parameters (P)
    fem::Effects effects;   // in force beyond the model's own
};

/// Internal variables of a history-dependent body; each model defines its own.
class Memory {
public:
    virtual ~Memory() = default;
};

/// What acts in a state and is known.
struct Action {
    std::vector<mesh::Contact> contacts;
    Vec3 gravity = Vec3::Zero();                     // [mm/s^2]
    double pressure = 0;                             // in closed cavities [MPa]
    std::shared_ptr<const Memory> memory = nullptr;  // of what the body went through before; none: it is virgin
    // Of the model's tools and actuators. A tool without a motion is away, a coordinate that is NaN is free: the tool
    // is where no force acts along it. An actuator without a setting is at 0: a tendon by length keeps its length.
    std::vector<mesh::ToolMotion> motions = {};
    std::vector<mesh::ActuatorSetting> settings = {};
};

/// Derivatives of the reactions of t tools.
///
/// A pose's steps are three translations and a turn, a rotation vector in space, about the moved origin. As forces of
/// tools are a gradient, minus the transpose of `by_step` is d residual / d pose: what an error of an imposed motion
/// does.
struct ReactionSlopes {
    Eigen::MatrixXd by_step;       // d reactions / d step (6t x dofs)
    Eigen::MatrixXd by_parameter;  // d reactions / d theta where q stays (6t x P): what tools press through is a layer
                                   // whose stiffness is a share of the body's
    Eigen::MatrixXd by_pose;       // d reactions / d pose where q stays (6t x 6t), a block for each tool
};

/// J = -d residual / d step in some configuration, factored.
class Tangent {
public:
    virtual ~Tangent() = default;
    /// J^-1 B (dofs x p), zero at what is held. Safe from several threads.
    virtual Eigen::MatrixXd solve(const Eigen::MatrixXd& B) const = 0;
    /// Memory that it takes [GB].
    virtual double gigabytes() const = 0;
};

/// What a finer mesh alters in what is read of an equilibrium.
struct MeshError {
    Points markers;             // (m x 3) [mm]
    Eigen::VectorXd reactions;  // force and moment of each of the action's motions (6 motions) [N, N mm]
};

/// Equilibria of a body, and how forces change about them. All members are const and safe from several threads.
///
/// A configuration q is a vector of the model's own; a step of it is (dofs). Residuals are generalized forces (dofs).
class BodyStatics {
public:
    virtual ~BodyStatics() = default;

    virtual int dofs() const = 0;
    virtual const std::vector<std::string>& laws() const = 0;
    virtual const std::vector<StiffnessParameter>& parameters() const = 0;
    /// Young's modulus that a setting amounts to [MPa]; for how deep a contact may dent.
    virtual double young(const ModelSetting& setting) const = 0;
    /// Does the law bend and turn with the body?
    virtual bool is_nonlinear(const ModelSetting& setting) const = 0;

    /// Undeformed.
    virtual Eigen::VectorXd rest(const ModelSetting& setting) const = 0;
    /// A configuration moved on by a step.
    virtual Eigen::VectorXd advance(const Eigen::VectorXd& q, const Eigen::VectorXd& step,
                                    const ModelSetting& setting) const = 0;

    /// Where all net forces vanish. `start`: a neighbouring configuration; `guide`: the tangent of one, under whatever
    /// setting, which steps from the start may go by. @throws SolverFailure where there is none.
    virtual Eigen::VectorXd equilibrium(const ModelSetting& setting, const Action& action,
                                        const Eigen::VectorXd* start = nullptr,
                                        const Tangent* guide = nullptr) const = 0;
    /// Net generalized force; minus the reaction at what is held.
    virtual Eigen::VectorXd residual(const Eigen::VectorXd& q, const ModelSetting& setting,
                                     const Action& action) const = 0;
    /// The factored tangent. @throws SolverFailure when it is not positive definite.
    virtual std::shared_ptr<const Tangent> tangent(const Eigen::VectorXd& q, const ModelSetting& setting,
                                                   const Action& action) const = 0;
    /// d residual / d theta (dofs x P): the force signatures of the stiffness parameters.
    virtual Eigen::MatrixXd parameter_force(const Eigen::VectorXd& q, const ModelSetting& setting,
                                            const Action& action) const = 0;
    /// J * step, at what is held too (dofs x p).
    virtual Eigen::MatrixXd tangent_times(const Eigen::VectorXd& q, const ModelSetting& setting, const Action& action,
                                          const Eigen::MatrixXd& steps) const = 0;
    /// The generalized force of one contact (dofs).
    virtual Eigen::VectorXd contact_force(const Eigen::VectorXd& q, const ModelSetting& setting,
                                          const mesh::Contact& contact) const = 0;
    /// d residual / d ln stiffness of weighted pieces (dofs x c); W (p x c).
    virtual Eigen::MatrixXd piece_force(const Eigen::VectorXd& q, const ModelSetting& setting, const Action& action,
                                        const Eigen::MatrixXd& W) const = 0;
    /// What the body keeps of an equilibrium, and of what it remembered in it; nothing where its material does not
    /// remember.
    virtual std::shared_ptr<const Memory> remember(const Eigen::VectorXd& q, const ModelSetting& setting,
                                                   const Action& action) const = 0;

    /// What a finer mesh would alter in an equilibrium with the tangent J; nothing where the model has no such mesh, or
    /// cannot tell.
    virtual std::optional<MeshError> discretisation_error(const Eigen::VectorXd& /*q*/, const ModelSetting& /*setting*/,
                                                          const Action& /*action*/, const Tangent& /*J*/) const {
        return std::nullopt;
    }
    /// The share of it, 1 sd, that is left where the finer mesh is one of the action's own; nothing: it is none.
    virtual std::optional<double> remaining_mesh_error(const Action& /*action*/) const { return std::nullopt; }

    // Tools and actuators, in the order of an action's motions (t) and settings (a).

    /// The motions, free coordinates found.
    virtual std::vector<mesh::ToolMotion> motions(const Eigen::VectorXd& q, const ModelSetting& setting,
                                                  const Action& action) const = 0;
    /// Force of each tool on the body, and moment about the tool's moved origin, by virtual work (6t) [N, N mm].
    virtual Eigen::VectorXd reactions(const Eigen::VectorXd& q, const ModelSetting& setting,
                                      const Action& action) const = 0;
    /// How they change, on their own where nothing is said.
    virtual ReactionSlopes reaction_slopes(const Eigen::VectorXd& q, const ModelSetting& setting,
                                           const Action& action) const = 0;
    /// d residual / d value of each setting (dofs x a).
    virtual Eigen::MatrixXd actuation_force(const Eigen::VectorXd& q, const ModelSetting& setting,
                                            const Action& action) const = 0;
};

}  // namespace palpate::identify
