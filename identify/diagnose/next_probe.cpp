#include "identify/diagnose/next_probe.h"

#include <fmt/format.h>

#include <algorithm>

#include "identify/parallel.h"
#include "mesh/errors.h"
#include "mesh/sampling.h"

namespace palpate::identify {
namespace {

/// Pushes at places over the markers, inwards, as strong as the set's own probes are on average.
std::vector<Action> loads_to_try(const BodyModel& model, const Problem& problem) {
    double force = 0, radius = 0;
    int count = 0;
    for (const Action& action : problem.actions) {
        for (const mesh::Contact& contact : action.contacts) {
            force += contact.force.norm();
            radius += contact.radius;
            ++count;
        }
    }
    std::vector<Action> actions;
    if (count == 0) return actions;
    for (const int marker : mesh::farthest_points(problem.rest, 16)) {
        const Vec3 at = problem.rest.row(marker);
        const Vec3 push = -force / count * model.normal_near(at, 0.05 * model.size());
        actions.push_back({.contacts = {{.point = at, .force = push, .radius = radius / count}}});
    }
    return actions;
}

/// Marker positions under a new load, or none where the body cannot carry it.
std::optional<Points> play_one(const BodyModel& model, const Problem& problem, const Explanation& explanation,
                               const Action& action) {
    try {
        const Setting setting = explanation.setting();
        return explanation.see(problem, model.observe(model.equilibrium(setting, action), setting));
    } catch (const SolverFailure&) {
        return std::nullopt;
    }
}

}  // namespace

NextProbe separate(const BodyModel& model, const Problem& problem, const Explained& a, const Explained& b,
                   int threads) {
    // what one has and the other has not
    const auto own = [](const Explained& of, const Explained& other) {
        const auto found =
            std::ranges::find_if(of.effects, [&](const auto& effect) { return !other.has(effect->name()); });
        return found == of.effects.end() ? of.effects.front() : *found;
    };
    const EffectDescription& text = own(a, b)->description();
    NextProbe result{
        .kind = text.next_probe,
        .why = fmt::format("separates {} from {}: {}", text.name, own(b, a)->name(), text.separating_probe)};
    if (result.kind != "load") return result;

    const std::vector<Action> actions = loads_to_try(model, problem);
    std::vector<double> apart(actions.size(), 0.0);
    for_each_in_parallel(static_cast<int>(actions.size()), threads, [&](int i) {
        const auto one = play_one(model, problem, a.fit.explanation, actions[i]);
        const auto other = play_one(model, problem, b.fit.explanation, actions[i]);
        if (one && other) apart[i] = (*one - *other).norm();
    });
    if (actions.empty()) return result;
    result.contact = actions[std::ranges::max_element(apart) - apart.begin()].contacts.front();
    return result;
}

}  // namespace palpate::identify
