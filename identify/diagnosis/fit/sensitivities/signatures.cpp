// What the numbers of an explanation do to forces at fixed configuration.

#include <algorithm>
#include <array>
#include <cmath>

#include "identify/diagnosis/fit/explanation.h"

namespace palpate::identify {
namespace {

/// An explanation with one number of one effect moved to both sides.
struct Sides {
    double h;
    Explanation ahead, behind;
};

Sides about(const Explanation& explanation, std::size_t effect, Eigen::Index number) {
    // The residual is exact to rounding, and kinks where a plane is just touched: a small step.
    Sides sides{1e-7 * std::max(1.0, std::abs(explanation.values[effect][number])), explanation, explanation};
    sides.ahead.values[effect][number] += sides.h;
    sides.behind.values[effect][number] -= sides.h;
    return sides;
}

/// What numbers do at fixed configuration.
struct AtOnce {
    Eigen::MatrixXd forces;     // d net force (dofs x numbers)
    Eigen::MatrixXd reactions;  // d reactions of the action's tools (6 motions x numbers)
};

/// Of an effect, by central differences.
AtOnce effect_at_once(const BodyModel& model, const Problem& problem, const Explanation& explanation,
                      std::size_t effect, const ForwardSolution& forward, int k, const Eigen::VectorXd& q) {
    const Eigen::VectorXd& values = explanation.values[effect];
    const auto tools = std::ssize(forward.actions[k].motions);
    AtOnce result{Eigen::MatrixXd::Zero(model.dofs(), values.size()), Eigen::MatrixXd::Zero(6 * tools, values.size())};
    ModelSetting setting = explanation.setting();
    if (const auto slopes = explanation.effects[effect]->piece_slopes(model, values)) {
        result.forces = model.piece_force(q, setting, forward.actions[k], *slopes);
        return result;
    }
    const bool enforced = explanation.effects[effect]->enforce(values, setting);
    for (Eigen::Index j = 0; j < values.size(); ++j) {
        if (!explanation.effects[effect]->is_fitted(j)) continue;
        const Sides sides = about(explanation, effect, j);
        Action ahead = sides.ahead.act(problem, k), behind = sides.behind.act(problem, k);
        if (!enforced && is_same(ahead, behind)) continue;
        ahead.memory = behind.memory = forward.actions[k].memory;
        const ModelSetting more = sides.ahead.setting(), less = sides.behind.setting();
        result.forces.col(j) = (model.residual(q, more, ahead) - model.residual(q, less, behind)) / (2 * sides.h);
        if (tools == 0) continue;
        result.reactions.col(j) = (model.reactions(q, more, ahead) - model.reactions(q, less, behind)) / (2 * sides.h);
    }
    return result;
}

/// Without the columns that are zero.
Signatures::InAction as_signatures(const AtOnce& all) {
    Signatures::InAction result;
    for (int c = 0; c < all.forces.cols(); ++c) {
        if (!all.forces.col(c).isZero(0) || !all.reactions.col(c).isZero(0)) result.columns.push_back(c);
    }
    result.forces = all.forces(Eigen::all, result.columns);
    result.reactions = all.reactions(Eigen::all, result.columns);
    return result;
}

/// What tools feel of the stiffness parameters at once (6 motions x P).
Eigen::MatrixXd felt_of_stiffness(const BodyModel& model, const ModelSetting& setting, const Action& action,
                                  const Eigen::VectorXd& q) {
    if (action.motions.empty()) return Eigen::MatrixXd::Zero(0, setting.theta.size());
    return model.reaction_slopes(q, setting, action).by_parameter;
}

/// d net force / d all numbers in every action of a body that remembers (K of dofs x numbers). What it remembers
/// depends on the numbers too: for each parameter two perturbed load histories are followed, with a slightly larger and
/// a slightly smaller value.
std::vector<Eigen::MatrixXd> remembering_forces(const BodyModel& model, const Problem& problem,
                                                const Explanation& explanation, const ForwardSolution& forward) {
    struct PerturbedHistory {
        ModelSetting setting;
        Explanation explanation;
        double h;
        std::vector<std::shared_ptr<const Memory>> after;  // each action
    };
    const auto count = static_cast<int>(problem.actions.size());
    const Eigen::Index numbers = explanation.numbers();
    const Eigen::VectorXd x = explanation.all();
    std::vector<std::array<PerturbedHistory, 2>> histories(numbers);
    for (Eigen::Index j = 0; j < numbers; ++j) {
        for (int side = 0; side < 2; ++side) {
            PerturbedHistory& history = histories[j][side];
            history.h = (side == 0 ? 1e-4 : -1e-4) * std::max(1.0, std::abs(x[j]));
            history.explanation = explanation;
            history.explanation.set_all(x + history.h * Eigen::VectorXd::Unit(numbers, j));
            history.setting = history.explanation.setting();
            history.after.resize(count);
        }
    }
    const ModelSetting setting = explanation.setting();
    std::vector<Eigen::MatrixXd> forces(count, Eigen::MatrixXd(model.dofs(), numbers));
    for (int k = 0; k < count; ++k) {
        const int before = problem.before(k);
        const auto action_of = [&](const PerturbedHistory& history) {
            Action action = history.explanation.act(problem, k);
            action.memory = before < 0 ? nullptr : history.after[before];
            return action;
        };
        for (Eigen::Index j = 0; j < numbers; ++j) {
            const auto& [more, less] = histories[j];
            forces[k].col(j) = (model.residual(forward.q[k], more.setting, action_of(more)) -
                                model.residual(forward.q[k], less.setting, action_of(less))) /
                               (more.h - less.h);
        }
        const Eigen::MatrixXd steps = tangent_of(model, setting, forward, k)->solve(forces[k]);
        for (Eigen::Index j = 0; j < numbers; ++j) {
            for (PerturbedHistory& history : histories[j]) {
                const Eigen::VectorXd q = model.advance(forward.q[k], history.h * steps.col(j), history.setting);
                history.after[k] = model.remember(q, history.setting, action_of(history));
            }
        }
    }
    return forces;
}

}  // namespace

Signatures own_signatures(const BodyModel& model, const Problem& problem, const Explanation& explanation,
                          const ForwardSolution& forward) {
    const ModelSetting setting = explanation.setting();
    std::vector<Eigen::MatrixXd> remembering;
    if (setting.effects.remember()) remembering = remembering_forces(model, problem, explanation, forward);
    return {explanation.numbers(),
            [&model, &problem, explanation, setting, &forward, remembering](int k, const Eigen::VectorXd& q) {
                const Action& action = forward.actions[k];
                const Eigen::Index numbers = explanation.numbers(), P = explanation.theta.size();
                AtOnce all{Eigen::MatrixXd(model.dofs(), numbers),
                           Eigen::MatrixXd::Zero(6 * std::ssize(action.motions), numbers)};
                all.reactions.leftCols(P) = felt_of_stiffness(model, setting, action, q);
                if (!remembering.empty()) {
                    all.forces = remembering[k];
                    return as_signatures(all);
                }
                all.forces.leftCols(P) = model.parameter_force(q, setting, action);
                Eigen::Index at = P;
                for (std::size_t e = 0; e < explanation.effects.size(); ++e) {
                    const Eigen::Index count = explanation.values[e].size();
                    if (count > 0) {
                        const AtOnce own = effect_at_once(model, problem, explanation, e, forward, k, q);
                        all.forces.middleCols(at, count) = own.forces;
                        all.reactions.middleCols(at, count) = own.reactions;
                    }
                    at += count;
                }
                return as_signatures(all);
            }};
}

Signatures::InAction signatures_of_last_effect(const BodyModel& model, const Problem& problem,
                                               const Explanation& explanation, const ForwardSolution& forward, int k,
                                               const Eigen::VectorXd& q) {
    return as_signatures(effect_at_once(model, problem, explanation, explanation.effects.size() - 1, forward, k, q));
}

}  // namespace palpate::identify
