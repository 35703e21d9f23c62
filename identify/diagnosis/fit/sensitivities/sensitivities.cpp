// What the numbers of an explanation alter in the readings, to first order.

#include "identify/diagnosis/fit/explanation.h"
#include "identify/numerics/parallel.h"

namespace palpate::identify {
namespace {

/// Puts what concerns the reactions of an action's tools (6 motions x c) in its place among the channels.
void add_reactions(const Problem& problem, const Action& action, const Eigen::MatrixXd& reactions,
                   Eigen::MatrixXd& channels) {
    for (std::size_t i = 0; i < action.motions.size(); ++i) {
        channels.middleRows<6>(3 * (problem.markers + 2 * Eigen::Index{action.motions[i].tool})) +=
            reactions.middleRows<6>(6 * static_cast<Eigen::Index>(i));
    }
}

/// What steps of the configuration (dofs x c) alter in the channels (3 (m + 2t) x c). `at_once` (6 motions x c):
/// what tools feel besides; or empty.
Eigen::MatrixXd channels_of_steps(const BodyModel& model, const Problem& problem, const ModelSetting& setting,
                                  const Action& action, const Eigen::VectorXd& q, const Eigen::MatrixXd& steps,
                                  const Eigen::MatrixXd& at_once) {
    Eigen::MatrixXd channels = Eigen::MatrixXd::Zero(problem.rest.size(), steps.cols());
    channels.topRows(3 * Eigen::Index{problem.markers}) = model.observation(q, setting) * steps;
    if (action.motions.empty()) return channels;
    add_reactions(problem, action, model.reaction_slopes(q, setting, action).by_step * steps, channels);
    if (at_once.size() > 0) add_reactions(problem, action, at_once, channels);
    return channels;
}

/// What is read of changes of the channels (3 (m + 2t) x c): differences of an affine map.
Eigen::MatrixXd seen_difference(const Problem& problem, const Explanation& explanation, const Points& markers,
                                const Eigen::MatrixXd& moved) {
    if (explanation.effects.empty()) return moved;
    const Points base = explanation.read(problem, markers);
    Eigen::MatrixXd result(moved.rows(), moved.cols());
    for (Eigen::Index c = 0; c < moved.cols(); ++c) {
        const Eigen::VectorXd column = moved.col(c);
        const Points there = markers + Eigen::Map<const Points>(column.data(), markers.rows(), 3);
        const Points difference = explanation.read(problem, there) - base;
        result.col(c) = Eigen::Map<const Eigen::VectorXd>(difference.data(), difference.size());
    }
    return result;
}

}  // namespace

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
    // Of actions that differences count from, for each signature: they come off when all threads are done.
    struct Counted {
        Eigen::MatrixXd seen;
        std::vector<int> columns;
    };
    std::vector<std::vector<Counted>> counted(count);
    std::vector<char> is_counted_from(count, 0);
    for (Eigen::Index n = 0; n < problem.rows(); ++n) {
        rows[problem.action[n]].push_back(n);
        if (problem.is_difference(n)) is_counted_from[problem.since[n]] = 1;
    }

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
            const Eigen::MatrixXd Y = seen_difference(problem, explanation, forward.channels[k],
                                                      channels_of_steps(model, problem, setting, forward.actions[k],
                                                                        forward.q[k], steps, parts[p].reactions));
            for (std::size_t c = 0; c < parts[p].columns.size(); ++c) {
                for (const Eigen::Index n : rows[k]) {
                    result[p](n, parts[p].columns[c]) =
                        Y(problem.coordinate[n], static_cast<Eigen::Index>(c)) / problem.sigma[n];
                }
            }
            if (is_counted_from[k]) counted[k].push_back({Y, parts[p].columns});
        }
    });
    for (Eigen::Index n = 0; n < problem.rows(); ++n) {
        if (!problem.is_difference(n)) continue;
        const std::vector<Counted>& from = counted[problem.since[n]];
        for (std::size_t p = 0; p < from.size(); ++p)
            for (std::size_t c = 0; c < from[p].columns.size(); ++c)
                result[p](n, from[p].columns[c]) -=
                    from[p].seen(problem.coordinate[n], static_cast<Eigen::Index>(c)) / problem.sigma[n];
    }
    return result;
}

Eigen::MatrixXd seen_directly(const BodyModel& model, const Problem& problem, const Explanation& explanation,
                              const ForwardSolution& forward) {
    const auto seen = [&](const Explanation& by, std::size_t k) {
        const ModelSetting setting = by.setting();
        if (setting.effects.growth.none()) return by.read(problem, forward.channels[k]);
        // What has grown carries its markers farther out, wherever it is.
        Points stand = forward.channels[k];
        stand.topRows(problem.markers) = model.observe(forward.q[k], setting);
        return by.read(problem, stand);
    };
    Eigen::MatrixXd result = Eigen::MatrixXd::Zero(problem.rows(), explanation.numbers());
    // By central differences of what is seen: exact to rounding for maps as smooth as a small rotation.
    Eigen::Index column = explanation.theta.size();
    for (std::size_t e = 0; e < explanation.effects.size(); ++e) {
        for (Eigen::Index j = 0; j < explanation.values[e].size(); ++j, ++column) {
            if (!explanation.effects[e]->is_fitted(j)) continue;
            constexpr double h = 1e-5;
            Explanation ahead = explanation, behind = explanation;
            ahead.values[e][j] += h;
            behind.values[e][j] -= h;
            std::vector<Points> difference;
            for (std::size_t k = 0; k < forward.channels.size(); ++k)
                difference.emplace_back((seen(ahead, k) - seen(behind, k)) / (2 * h));
            result.col(column) = problem.pick(difference).cwiseQuotient(problem.sigma);
        }
    }
    return result;
}

}  // namespace palpate::identify
