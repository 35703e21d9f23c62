#include "identify/diagnosis/fit/explanation.h"

#include <algorithm>

#include "identify/numerics/parallel.h"
#include "mesh/errors.h"

namespace palpate::identify {
namespace {

/// Nothing that an unloaded state could show: no contact, no gravity, no effect that moves it.
bool at_rest(const ModelSetting& setting, const Action& action) {
    return !is_loaded(action) && action.gravity.isZero(0) && action.pressure == 0 && setting.effects.empty();
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

Points Explanation::see(const Problem& problem, const Points& points) const {
    Points seen = points;
    for (std::size_t e = 0; e < effects.size(); ++e) seen = effects[e]->see(problem, seen, values[e]);
    return seen;
}

Points Explanation::read(const Problem& problem, const Points& channels) const {
    Points result = channels;
    result.topRows(problem.markers) = see(problem, channels.topRows(problem.markers));
    return result;
}

Points channels_of(const BodyModel& model, const Problem& problem, const ModelSetting& setting, const Action& action,
                   const Eigen::VectorXd& q) {
    Points channels = Points::Zero(problem.rest.rows(), 3);
    channels.topRows(problem.markers) = model.observe(q, setting);
    if (action.motions.empty()) return channels;
    const Eigen::VectorXd reactions = model.reactions(q, setting, action);
    for (std::size_t i = 0; i < action.motions.size(); ++i) {
        const int force = problem.markers + 2 * action.motions[i].tool;
        channels.row(force) = reactions.segment<3>(6 * static_cast<Eigen::Index>(i));
        channels.row(force + 1) = reactions.segment<3>(6 * static_cast<Eigen::Index>(i) + 3);
    }
    return channels;
}

std::shared_ptr<const Tangent> tangent_of(const BodyModel& model, const ModelSetting& setting,
                                          const ForwardSolution& forward, int k) {
    const auto make = [&] { return model.tangent(forward.q[k], setting, forward.actions[k]); };
    return forward.tangents ? forward.tangents->get(k, make) : make();
}

bool has_equilibrium(const BodyModel& model, const ModelSetting& setting, const Action& action) {
    try {
        model.equilibrium(setting, action);
        return true;
    } catch (const SolverFailure&) {
        return false;
    }
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
    const bool remembers = setting.effects.remember();
    std::vector<std::shared_ptr<const Memory>> after(count);
    for_each_in_parallel(count, remembers ? 1 : threads, [&](int k) {
        Action& action = result.actions[k];
        action = explanation.act(problem, k);
        if (remembers && problem.before(k) >= 0) action.memory = after[problem.before(k)];
        if (at_rest(setting, action)) {
            result.q[k] = rest;
        } else if (linear) {
            result.q[k] = model.advance(rest, linear->solve(model.residual(rest, setting, action)), setting);
        } else {
            const bool is_begun = start && (*start)[k].size() > 0;
            result.q[k] = model.equilibrium(setting, action, is_begun ? &(*start)[k] : nullptr,
                                            guides ? guides->kept(k) : nullptr);
        }
        if (remembers) after[k] = model.remember(result.q[k], setting, action);
        result.channels[k] = channels_of(model, problem, setting, action, result.q[k]);
        result.markers[k] = explanation.read(problem, result.channels[k]);
    });
    return result;
}

}  // namespace palpate::identify
