#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "identify/diagnose/kept_tangents.h"
#include "identify/diagnose/problem.h"
#include "identify/effects/effect.h"

namespace palpate::identify {

/// What explains a set: a law and a number for everything that is free.
struct Explanation {
    int law = 0;
    Eigen::VectorXd theta;  // stiffness parameters of the model
    std::vector<std::shared_ptr<const Effect>> effects;
    std::vector<Eigen::VectorXd> values;  // of each effect

    Eigen::Index numbers() const;
    /// Does what happened before matter? Then it explains problems stage by stage only.
    bool has_memory() const;
    /// All numbers one after the other: stiffness, then the effects'.
    Eigen::VectorXd all() const;
    void set_all(const Eigen::VectorXd& all);
    Setting setting() const;
    /// What acts in action k once the effects had their say.
    Action act(const Problem& problem, int k) const;
    Points see(const Problem& problem, const Points& markers) const;
};

/// A model in all actions of a problem, as an explanation has it.
struct Played {
    std::vector<Action> actions;                       // as the effects make them, with what the body remembers (K)
    std::vector<Eigen::VectorXd> q;                    // configurations (K)
    std::vector<Points> stand;                         // where the markers stand (K of m x 3) [mm]
    std::vector<Points> markers;                       // as they are seen
    std::shared_ptr<KeptTangents> tangents = nullptr;  // there; none: they are made anew each time
};

/// @pre the problem is stage by stage where the explanation has a memory.
/// @throws SolverFailure where an action has no equilibrium. `start`, `guides`: configurations and tangents of a
/// neighbouring explanation.
Played play(const BodyModel& model, const Problem& problem, const Explanation& explanation, int threads,
            const std::vector<Eigen::VectorXd>* start = nullptr, const KeptTangents* guides = nullptr);

/// How the coordinates answer to signatures at the played configurations, over sigma: P (J^-1 forces + steps), seen
/// through the explanation (N x width each). One factorisation an action serves all.
/// `steps_of_first` (when asked for): J^-1 forces of the first signatures (K of dofs x width).
std::vector<Eigen::MatrixXd> answers(const BodyModel& model, const Problem& problem, const Explanation& explanation,
                                     const Played& played, const std::vector<Signatures>& signatures, int threads,
                                     std::vector<Eigen::MatrixXd>* steps_of_first = nullptr);

/// The signatures of all of an explanation's numbers, an effect's by central differences of the net force; where the
/// body yields, with all that it remembers by then.
Signatures own_signatures(const BodyModel& model, const Problem& problem, const Explanation& explanation,
                          const Played& played);

/// The same of its last effect alone, which need not be in force.
Signatures::InAction signatures_of_last_effect(const BodyModel& model, const Problem& problem,
                                               const Explanation& explanation, const Played& played, int k,
                                               const Eigen::VectorXd& q);

/// What the explanation's numbers do to what is seen without moving the body, over sigma (N x numbers).
Eigen::MatrixXd seen_directly(const Problem& problem, const Explanation& explanation, const Played& played);

}  // namespace palpate::identify
