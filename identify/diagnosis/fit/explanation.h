#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "identify/diagnosis/fit/tangent_cache.h"
#include "identify/diagnosis/problem.h"
#include "identify/effects/effect.h"

namespace palpate::identify {

/// What explains a set: a law and a number for everything that is free.
struct Explanation {
    int law = 0;
    Eigen::VectorXd theta;  // stiffness parameters of the model
    std::vector<std::shared_ptr<const EffectHypothesis>> effects;
    std::vector<Eigen::VectorXd> values;  // of each effect

    Eigen::Index numbers() const;
    /// Is the response history-dependent? Then it applies to stage-by-stage problems only.
    bool has_memory() const;
    /// All numbers one after the other: stiffness, then the effects'.
    Eigen::VectorXd all() const;
    void set_all(const Eigen::VectorXd& all);
    ModelSetting setting() const;
    /// Action k as modified by the effects.
    Action act(const Problem& problem, int k) const;
    Points see(const Problem& problem, const Points& points) const;     // as they are measured (any x 3)
    Points read(const Problem& problem, const Points& channels) const;  // the markers among them so (m + 2t x 3)
};

/// A model in all actions of a problem, as an explanation has it.
struct ForwardSolution {
    std::vector<Action> actions;                       // as the effects make them, with what the body remembers (K)
    std::vector<Eigen::VectorXd> q;                    // configurations (K)
    std::vector<Points> channels;                      // where markers stand, what tools feel (K of m + 2t x 3)
    std::vector<Points> markers;                       // the same as they are read
    std::shared_ptr<TangentCache> tangents = nullptr;  // there; none: they are made anew each time
};

/// The channels in a configuration: where the markers stand, and the reactions of the tools that touch (m + 2t x 3).
Points channels_of(const BodyModel& model, const Problem& problem, const ModelSetting& setting, const Action& action,
                   const Eigen::VectorXd& q);

/// @pre the problem is stage by stage where the explanation has a memory.
/// @throws SolverFailure where an action has no equilibrium. `start`, `guides`: configurations and tangents of a
/// neighbouring explanation; an empty configuration: that action begins at rest, or where its tools stood in the
/// probe's action before it.
ForwardSolution solve_forward(const BodyModel& model, const Problem& problem, const Explanation& explanation,
                              int threads, const std::vector<Eigen::VectorXd>* start = nullptr,
                              const TangentCache* guides = nullptr);

/// The factored tangent of a solution in action k: the one that is there, else a new one.
std::shared_ptr<const Tangent> tangent_of(const BodyModel& model, const ModelSetting& setting,
                                          const ForwardSolution& forward, int k);

/// Does the body bear an action, from rest?
bool has_equilibrium(const BodyModel& model, const ModelSetting& setting, const Action& action);

/// Sensitivities of the measured coordinates to force signatures at the solved configurations, over sigma: P (J^-1
/// forces + steps), through the measurement effects of the explanation (N x width each). One factorisation an action
/// serves all. `steps_of_first` (when asked for): J^-1 forces of the first signatures (K of dofs x width).
std::vector<Eigen::MatrixXd> sensitivities(const BodyModel& model, const Problem& problem,
                                           const Explanation& explanation, const ForwardSolution& forward,
                                           const std::vector<Signatures>& signatures, int threads,
                                           std::vector<Eigen::MatrixXd>* steps_of_first = nullptr);

/// Force signatures of all parameters of an explanation, those of effects by central differences of the net force; for
/// a yielding body including its load history.
Signatures own_signatures(const BodyModel& model, const Problem& problem, const Explanation& explanation,
                          const ForwardSolution& forward);

/// The same of its last effect alone, which need not be in force.
Signatures::InAction signatures_of_last_effect(const BodyModel& model, const Problem& problem,
                                               const Explanation& explanation, const ForwardSolution& forward, int k,
                                               const Eigen::VectorXd& q);

/// Direct sensitivity of the readings to the parameters, at fixed configuration, over sigma (N x parameters).
Eigen::MatrixXd seen_directly(const BodyModel& model, const Problem& problem, const Explanation& explanation,
                              const ForwardSolution& forward);

}  // namespace palpate::identify
