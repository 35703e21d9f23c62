#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <vector>

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
    std::vector<Eigen::VectorXd> q;  // configurations (K)
    std::vector<Points> stand;       // where the markers stand (K of m x 3) [mm]
    std::vector<Points> markers;     // as they are seen
};

/// @throws SolverFailure where an action has no equilibrium. `start`: of a neighbouring explanation.
Played play(const BodyModel& model, const Problem& problem, const Explanation& explanation, int threads,
            const std::vector<Eigen::VectorXd>* start = nullptr);

/// Force signatures that differ from action to action: columns of a wide matrix that most actions know nothing of.
struct Signatures {
    Eigen::Index width = 0;  // columns in all
    /// What it is in an action.
    struct InAction {
        Eigen::MatrixXd forces;      // (dofs x c) [N]
        Eigen::MatrixXd steps = {};  // that what is held makes besides (dofs x c), or empty
        std::vector<int> columns;    // of the wide matrix (c)
    };
    std::function<InAction(int k, const Eigen::VectorXd& q)> in_action;
};

/// How the coordinates answer to signatures at the played configurations, over sigma: P (J^-1 forces + steps), seen
/// through the explanation (N x width each). One factorisation an action serves all.
/// `steps_of_first` (when asked for): J^-1 forces of the first signatures (K of dofs x width).
std::vector<Eigen::MatrixXd> answers(const BodyModel& model, const Problem& problem, const Explanation& explanation,
                                     const Played& played, const std::vector<Signatures>& signatures, int threads,
                                     std::vector<Eigen::MatrixXd>* steps_of_first = nullptr);

/// The signatures of all of an explanation's numbers.
Signatures own_signatures(const BodyModel& model, const Problem& problem, const Explanation& explanation);

/// What the explanation's numbers do to what is seen without moving the body, over sigma (N x numbers).
Eigen::MatrixXd seen_directly(const Problem& problem, const Explanation& explanation, const Played& played);

}  // namespace palpate::identify
