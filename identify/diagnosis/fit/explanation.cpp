#include "identify/diagnosis/fit/explanation.h"

#include <algorithm>
#include <map>
#include <optional>

#include "identify/models/tool_path.h"
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

namespace {

/// What is solved one after the other, each sequence on its own: the life of a body that remembers; where it is not
/// known where states are about to be, those of a probe in which tools move on from one to the next.
std::vector<std::vector<int>> sequences(const Problem& problem, bool remembers, bool is_known) {
    std::map<int, std::vector<int>> result;
    for (int k = 0; k < static_cast<int>(problem.actions.size()); ++k) {
        const bool follows = !is_known && !problem.actions[k].motions.empty();
        const int alone = -2 - k;  // no probe's number
        result[remembers ? 0 : follows ? problem.probe[k] : alone].push_back(k);
    }
    std::vector<std::vector<int>> all;
    all.reserve(result.size());
    for (auto& [_, sequence] : result) all.push_back(std::move(sequence));
    return all;
}

}  // namespace

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
    const bool is_known = start && std::ranges::none_of(*start, [](const auto& q) { return q.size() == 0; });
    std::optional<PreparedRig> rig;  // of tools whose paths are followed
    if (!is_known && problem.rig) rig.emplace(*problem.rig);
    std::vector<std::shared_ptr<const Memory>> after(count);
    const auto solve = [&](int k, int previous) {
        Action& action = result.actions[k];
        action = explanation.act(problem, k);
        if (remembers && problem.before(k) >= 0) action.memory = after[problem.before(k)];
        const Eigen::VectorXd* near = start && (*start)[k].size() > 0 ? &(*start)[k] : nullptr;
        if (at_rest(setting, action)) {
            result.q[k] = rest;
        } else if (linear) {
            result.q[k] = model.advance(rest, linear->solve(model.residual(rest, setting, action)), setting);
        } else if (!near && previous >= 0 && problem.probe[previous] == problem.probe[k] &&
                   is_reached_from(result.actions[previous], action)) {
            result.q[k] = equilibrium_after(model, *rig, setting, result.actions[previous], result.q[previous], action);
        } else {
            result.q[k] = model.equilibrium(setting, action, near, guides ? guides->kept(k) : nullptr);
        }
        if (remembers) after[k] = model.remember(result.q[k], setting, action);
        result.channels[k] = channels_of(model, problem, setting, action, result.q[k]);
        result.markers[k] = explanation.read(problem, result.channels[k]);
    };
    const std::vector<std::vector<int>> all = sequences(problem, remembers, is_known);
    for_each_in_parallel(static_cast<int>(all.size()), threads, [&](int s) {
        int previous = -1;
        for (const int k : all[s]) {
            solve(k, previous);
            previous = k;
        }
    });
    return result;
}

}  // namespace palpate::identify
