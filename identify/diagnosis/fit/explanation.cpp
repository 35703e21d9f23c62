#include "identify/diagnosis/fit/explanation.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "identify/numerics/parallel.h"

namespace palpate::identify {
namespace {

/// Nothing that an unloaded state could show: no contact, no gravity, no effect that moves it.
bool at_rest(const ModelSetting& setting, const Action& action) {
    return action.contacts.empty() && action.gravity.isZero(0) && action.pressure == 0 && action.motions.empty() &&
           action.settings.empty() && setting.effects.empty();
}

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

bool same_forces(const Action& a, const Action& b) {
    return std::ranges::equal(a.contacts, b.contacts,
                              [](const mesh::Contact& x, const mesh::Contact& y) { return x.force == y.force; });
}

/// d net force / d numbers of an effect (dofs x numbers), by central differences.
Eigen::MatrixXd effect_forces(const BodyModel& model, const Problem& problem, const Explanation& explanation,
                              std::size_t effect, const ForwardSolution& forward, int k, const Eigen::VectorXd& q) {
    const Eigen::VectorXd& values = explanation.values[effect];
    Eigen::MatrixXd forces = Eigen::MatrixXd::Zero(model.dofs(), values.size());
    ModelSetting setting = explanation.setting();
    const bool enforced = explanation.effects[effect]->enforce(values, setting);
    for (Eigen::Index j = 0; j < values.size(); ++j) {
        const Sides sides = about(explanation, effect, j);
        Action ahead = sides.ahead.act(problem, k), behind = sides.behind.act(problem, k);
        if (!enforced && same_forces(ahead, behind)) continue;
        ahead.memory = behind.memory = forward.actions[k].memory;
        forces.col(j) =
            (model.residual(q, sides.ahead.setting(), ahead) - model.residual(q, sides.behind.setting(), behind)) /
            (2 * sides.h);
    }
    return forces;
}

std::shared_ptr<const Tangent> tangent_of(const BodyModel& model, const ModelSetting& setting,
                                          const ForwardSolution& forward, int k) {
    const auto make = [&] { return model.tangent(forward.q[k], setting, forward.actions[k]); };
    return forward.tangents ? forward.tangents->get(k, make) : make();
}

/// Without the columns that are zero.
Signatures::InAction as_signatures(const Eigen::MatrixXd& forces) {
    Signatures::InAction result;
    for (int c = 0; c < forces.cols(); ++c) {
        if (!forces.col(c).isZero(0)) result.columns.push_back(c);
    }
    result.forces = forces(Eigen::all, result.columns);
    return result;
}

/// d net force / d all numbers in every action of a body that yields (K of dofs x numbers). What it remembers depends
/// on the numbers too: for each parameter two perturbed load histories are followed, with a slightly larger and a
/// slightly smaller value.
std::vector<Eigen::MatrixXd> yielding_forces(const BodyModel& model, const Problem& problem,
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

/// What is seen of marker displacements (3m x c) at some positions: differences of an affine map.
Eigen::MatrixXd seen_difference(const Problem& problem, const Explanation& explanation, const Points& markers,
                                const Eigen::MatrixXd& moved) {
    if (explanation.effects.empty()) return moved;
    const Points base = explanation.see(problem, markers);
    Eigen::MatrixXd result(moved.rows(), moved.cols());
    for (Eigen::Index c = 0; c < moved.cols(); ++c) {
        const Eigen::VectorXd column = moved.col(c);
        const Points there = markers + Eigen::Map<const Points>(column.data(), markers.rows(), 3);
        const Points difference = explanation.see(problem, there) - base;
        result.col(c) = Eigen::Map<const Eigen::VectorXd>(difference.data(), difference.size());
    }
    return result;
}

}  // namespace

Eigen::Index Explanation::numbers() const {
    Eigen::Index count = theta.size();
    for (const auto& v : values) count += v.size();
    return count;
}

Eigen::VectorXd Explanation::all() const {
    Eigen::VectorXd result(numbers());
    result.head(theta.size()) = theta;
    Eigen::Index at = theta.size();
    for (const auto& v : values) {
        result.segment(at, v.size()) = v;
        at += v.size();
    }
    return result;
}

bool Explanation::has_memory() const {
    return std::ranges::any_of(effects, [](const auto& effect) { return effect->has_memory(); });
}

void Explanation::set_all(const Eigen::VectorXd& all) {
    theta = all.head(theta.size()).eval();
    Eigen::Index at = theta.size();
    for (auto& v : values) {
        v = all.segment(at, v.size()).eval();
        at += v.size();
    }
}

ModelSetting Explanation::setting() const {
    ModelSetting result{law, theta, {}};
    for (std::size_t e = 0; e < effects.size(); ++e) effects[e]->enforce(values[e], result);
    return result;
}

Action Explanation::act(const Problem& problem, int k) const {
    Action action = problem.actions[k];
    for (std::size_t e = 0; e < effects.size(); ++e) action = effects[e]->act(problem, k, action, values[e]);
    return action;
}

Points Explanation::see(const Problem& problem, const Points& markers) const {
    Points seen = markers;
    for (std::size_t e = 0; e < effects.size(); ++e) seen = effects[e]->see(problem, seen, values[e]);
    return seen;
}

ForwardSolution solve_forward(const BodyModel& model, const Problem& problem, const Explanation& explanation,
                              int threads, const std::vector<Eigen::VectorXd>* start, const TangentCache* guides) {
    const ModelSetting setting = explanation.setting();
    const auto count = static_cast<int>(problem.actions.size());
    ForwardSolution result{std::vector<Action>(count), std::vector<Eigen::VectorXd>(count), std::vector<Points>(count),
                           std::vector<Points>(count), std::make_shared<TangentCache>(count)};
    const Eigen::VectorXd rest = model.rest(setting);

    // A linear law: one factorisation, one step from rest.
    std::shared_ptr<const Tangent> linear;
    if (!model.is_nonlinear(setting)) linear = model.tangent(rest, setting, {});
    const bool yields = setting.effects.plasticity.has_value();
    std::vector<std::shared_ptr<const Memory>> after(count);
    for_each_in_parallel(count, yields ? 1 : threads, [&](int k) {
        Action& action = result.actions[k];
        action = explanation.act(problem, k);
        if (yields && problem.before(k) >= 0) action.memory = after[problem.before(k)];
        if (at_rest(setting, action)) {
            result.q[k] = rest;
        } else if (linear) {
            result.q[k] = model.advance(rest, linear->solve(model.residual(rest, setting, action)), setting);
        } else {
            result.q[k] =
                model.equilibrium(setting, action, start ? &(*start)[k] : nullptr, guides ? guides->kept(k) : nullptr);
        }
        if (yields) after[k] = model.remember(result.q[k], setting, action);
        result.stand[k] = model.observe(result.q[k], setting);
        result.markers[k] = explanation.see(problem, result.stand[k]);
    });
    return result;
}

std::vector<Eigen::MatrixXd> sensitivities(const BodyModel& model, const Problem& problem,
                                           const Explanation& explanation, const ForwardSolution& forward,
                                           const std::vector<Signatures>& signatures, int threads,
                                           std::vector<Eigen::MatrixXd>* steps_of_first) {
    const ModelSetting setting = explanation.setting();
    const auto count = static_cast<int>(problem.actions.size());
    std::vector<Eigen::MatrixXd> result;
    result.reserve(signatures.size());
    for (const Signatures& s : signatures) result.emplace_back(Eigen::MatrixXd::Zero(problem.rows(), s.width));
    if (steps_of_first) steps_of_first->assign(count, {});
    std::vector<std::vector<Eigen::Index>> rows(count);
    for (Eigen::Index n = 0; n < problem.rows(); ++n) rows[problem.action[n]].push_back(n);

    std::shared_ptr<const Tangent> linear;
    if (!model.is_nonlinear(setting)) linear = model.tangent(model.rest(setting), setting, {});
    for_each_in_parallel(count, threads, [&](int k) {
        std::vector<Signatures::InAction> parts;
        Eigen::Index columns = 0;
        for (const Signatures& s : signatures) {
            parts.push_back(s.in_action(k, forward.q[k]));
            columns += parts.back().forces.cols();
        }
        if (columns == 0) return;
        Eigen::MatrixXd G(model.dofs(), columns);
        Eigen::Index at = 0;
        for (const auto& part : parts) {
            if (part.forces.cols() > 0) G.middleCols(at, part.forces.cols()) = part.forces;
            at += part.forces.cols();
        }
        const auto tangent = linear ? linear : tangent_of(model, setting, forward, k);
        const Eigen::MatrixXd X = tangent->solve(G);
        const Eigen::SparseMatrix<double> P = model.observation(forward.q[k], setting);
        at = 0;
        for (std::size_t p = 0; p < parts.size(); ++p) {
            Eigen::MatrixXd steps = X.middleCols(at, parts[p].forces.cols());
            at += parts[p].forces.cols();
            if (parts[p].steps.size() > 0) steps += parts[p].steps;
            if (parts[p].combine) steps = parts[p].combine(steps);
            if (p == 0 && steps_of_first) {
                (*steps_of_first)[k] = Eigen::MatrixXd::Zero(model.dofs(), signatures.front().width);
                (*steps_of_first)[k](Eigen::all, parts[p].columns) = steps;
            }
            const Eigen::MatrixXd Y = seen_difference(problem, explanation, forward.stand[k], P * steps);
            for (std::size_t c = 0; c < parts[p].columns.size(); ++c) {
                for (const Eigen::Index n : rows[k]) {
                    result[p](n, parts[p].columns[c]) =
                        Y(problem.coordinate[n], static_cast<Eigen::Index>(c)) / problem.sigma[n];
                }
            }
        }
    });
    return result;
}

Signatures own_signatures(const BodyModel& model, const Problem& problem, const Explanation& explanation,
                          const ForwardSolution& forward) {
    const ModelSetting setting = explanation.setting();
    std::vector<Eigen::MatrixXd> all;
    if (setting.effects.plasticity) all = yielding_forces(model, problem, explanation, forward);
    return {explanation.numbers(),
            [&model, &problem, explanation, setting, &forward, all](int k, const Eigen::VectorXd& q) {
                if (!all.empty()) return as_signatures(all[k]);
                Eigen::MatrixXd forces(model.dofs(), explanation.numbers());
                forces.leftCols(explanation.theta.size()) = model.parameter_force(q, setting, forward.actions[k]);
                Eigen::Index at = explanation.theta.size();
                for (std::size_t e = 0; e < explanation.effects.size(); ++e) {
                    const Eigen::Index count = explanation.values[e].size();
                    if (count > 0) {
                        forces.middleCols(at, count) = effect_forces(model, problem, explanation, e, forward, k, q);
                    }
                    at += count;
                }
                return as_signatures(forces);
            }};
}

Signatures::InAction signatures_of_last_effect(const BodyModel& model, const Problem& problem,
                                               const Explanation& explanation, const ForwardSolution& forward, int k,
                                               const Eigen::VectorXd& q) {
    return as_signatures(effect_forces(model, problem, explanation, explanation.effects.size() - 1, forward, k, q));
}

Eigen::MatrixXd seen_directly(const Problem& problem, const Explanation& explanation, const ForwardSolution& forward) {
    Eigen::MatrixXd result = Eigen::MatrixXd::Zero(problem.rows(), explanation.numbers());
    // By central differences of what is seen: exact to rounding for maps as smooth as a small rotation.
    Eigen::Index column = explanation.theta.size();
    for (std::size_t e = 0; e < explanation.effects.size(); ++e) {
        for (Eigen::Index j = 0; j < explanation.values[e].size(); ++j, ++column) {
            constexpr double h = 1e-5;
            Explanation ahead = explanation, behind = explanation;
            ahead.values[e][j] += h;
            behind.values[e][j] -= h;
            std::vector<Points> difference;
            for (const Points& stand : forward.stand) {
                difference.emplace_back((ahead.see(problem, stand) - behind.see(problem, stand)) / (2 * h));
            }
            result.col(column) = problem.pick(difference).cwiseQuotient(problem.sigma);
        }
    }
    return result;
}

}  // namespace palpate::identify
