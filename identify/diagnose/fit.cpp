#include "identify/diagnose/fit.h"

#include "identify/parallel.h"

namespace palpate::identify {
namespace {

/// Nothing that an unloaded state could show: no contact, no gravity, no effect that moves it.
bool at_rest(const Setting& setting, const Action& action) {
    return action.contacts.empty() && action.gravity.isZero(0) && setting.effects.empty();
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

void Explanation::set_all(const Eigen::VectorXd& all) {
    theta = all.head(theta.size()).eval();
    Eigen::Index at = theta.size();
    for (auto& v : values) {
        v = all.segment(at, v.size()).eval();
        at += v.size();
    }
}

Setting Explanation::setting() const {
    Setting result{law, theta, {}};
    for (std::size_t e = 0; e < effects.size(); ++e) {
        if (auto potential = effects[e]->potential(values[e])) result.effects.push_back(std::move(potential));
    }
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

Played play(const BodyModel& model, const Problem& problem, const Explanation& explanation, int threads,
            const std::vector<Eigen::VectorXd>* start) {
    const Setting setting = explanation.setting();
    const auto count = static_cast<int>(problem.actions.size());
    Played result{std::vector<Eigen::VectorXd>(count), std::vector<Points>(count), std::vector<Points>(count)};
    const Eigen::VectorXd rest = model.rest(setting);

    // A linear law: one factorisation, one step from rest.
    std::shared_ptr<const Tangent> linear;
    if (!model.is_nonlinear(setting)) linear = model.tangent(rest, setting, {});
    for_each_in_parallel(count, threads, [&](int k) {
        const Action action = explanation.act(problem, k);
        if (at_rest(setting, action)) {
            result.q[k] = rest;
        } else if (linear) {
            result.q[k] = model.advance(rest, linear->solve(model.residual(rest, setting, action)), setting);
        } else {
            result.q[k] = model.equilibrium(setting, action, start ? &(*start)[k] : nullptr);
        }
        result.stand[k] = model.observe(result.q[k], setting);
        result.markers[k] = explanation.see(problem, result.stand[k]);
    });
    return result;
}

std::vector<Eigen::MatrixXd> answers(const BodyModel& model, const Problem& problem, const Explanation& explanation,
                                     const Played& played, const std::vector<Signatures>& signatures, int threads,
                                     std::vector<Eigen::MatrixXd>* steps_of_first) {
    const Setting setting = explanation.setting();
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
            parts.push_back(s.in_action(k, played.q[k]));
            columns += parts.back().forces.cols();
        }
        if (columns == 0) return;
        Eigen::MatrixXd G(model.dofs(), columns);
        Eigen::Index at = 0;
        for (const auto& part : parts) {
            if (part.forces.cols() > 0) G.middleCols(at, part.forces.cols()) = part.forces;
            at += part.forces.cols();
        }
        const auto tangent = linear ? linear : model.tangent(played.q[k], setting, explanation.act(problem, k));
        Eigen::MatrixXd X = tangent->solve(G);
        at = 0;
        for (const auto& part : parts) {
            if (part.steps.size() > 0) X.middleCols(at, part.steps.cols()) += part.steps;
            at += part.forces.cols();
        }
        if (steps_of_first) {
            (*steps_of_first)[k] = Eigen::MatrixXd::Zero(model.dofs(), signatures.front().width);
            (*steps_of_first)[k](Eigen::all, parts.front().columns) = X.leftCols(parts.front().forces.cols());
        }
        const Eigen::MatrixXd Y =
            seen_difference(problem, explanation, played.stand[k], model.observation(played.q[k], setting) * X);
        at = 0;
        for (std::size_t p = 0; p < parts.size(); ++p) {
            for (std::size_t c = 0; c < parts[p].columns.size(); ++c) {
                for (const Eigen::Index n : rows[k]) {
                    result[p](n, parts[p].columns[c]) =
                        Y(problem.coordinate[n], at + static_cast<Eigen::Index>(c)) / problem.sigma[n];
                }
            }
            at += parts[p].forces.cols();
        }
    });
    return result;
}

Signatures own_signatures(const BodyModel& model, const Problem& problem, const Explanation& explanation) {
    const Setting setting = explanation.setting();
    return {explanation.numbers(), [&model, &problem, explanation, setting](int k, const Eigen::VectorXd& q) {
                Eigen::MatrixXd forces(model.dofs(), explanation.numbers());
                forces.leftCols(explanation.theta.size()) = model.parameter_force(q, setting);
                Eigen::Index at = explanation.theta.size();
                for (std::size_t e = 0; e < explanation.effects.size(); ++e) {
                    const Eigen::VectorXd& v = explanation.values[e];
                    if (v.size() > 0) {
                        forces.middleCols(at, v.size()) =
                            explanation.effects[e]->force(model, problem, setting, k, q, v);
                    }
                    at += v.size();
                }
                Signatures::InAction result;
                for (int c = 0; c < forces.cols(); ++c) {
                    if (!forces.col(c).isZero(0)) result.columns.push_back(c);
                }
                result.forces = forces(Eigen::all, result.columns);
                return result;
            }};
}

Eigen::MatrixXd seen_directly(const Problem& problem, const Explanation& explanation, const Played& played) {
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
            for (const Points& stand : played.stand) {
                difference.emplace_back((ahead.see(problem, stand) - behind.see(problem, stand)) / (2 * h));
            }
            result.col(column) = problem.pick(difference).cwiseQuotient(problem.sigma);
        }
    }
    return result;
}

}  // namespace palpate::identify
