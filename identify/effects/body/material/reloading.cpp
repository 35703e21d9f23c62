#include "identify/effects/body/material/reloading.h"

#include <algorithm>

#include "identify/numerics/summaries.h"

namespace palpate::identify {
namespace {

constexpr double alike = 0.99;  // of an amount: what is repeated need not be so to the last digit

/// `now` of at least `then`, as vectors along it.
bool reaches(const Vec3& now, const Vec3& then) { return now.dot(then) >= alike * then.squaredNorm(); }

/// Is all that acted then there, and as much of it?
bool is_as_much(const Action& now, const Action& then) {
    const auto pressed = [&](const mesh::Contact& was) {
        return std::ranges::any_of(now.contacts, [&](const mesh::Contact& is) {
            return (is.point - was.point).norm() <= 0.5 * was.radius + 1e-9 && reaches(is.force, was.force);
        });
    };
    const auto moved = [&](const mesh::ToolMotion& was) {
        return std::ranges::any_of(now.motions, [&](const mesh::ToolMotion& is) {
            // a coordinate that is free counts as 0
            return is.tool == was.tool && reaches(known_part(is.translation), known_part(was.translation)) &&
                   reaches(known_part(is.rotation), known_part(was.rotation));
        });
    };
    const auto driven = [&](const mesh::ActuatorSetting& was) {
        return std::ranges::any_of(now.settings, [&](const mesh::ActuatorSetting& is) {
            return is.actuator == was.actuator && is.value * was.value >= alike * was.value * was.value;
        });
    };
    return std::ranges::all_of(then.contacts, pressed) && std::ranges::all_of(then.motions, moved) &&
           std::ranges::all_of(then.settings, driven);
}

}  // namespace

bool bears_less_after_more(const Problem& problem) {
    std::vector<const Action*> borne;  // by the body since it was new
    for (std::size_t s = 0; s < problem.stages.size(); ++s) {
        const Stage& stage = problem.stages[s];
        if (!problem.continuous && s > 0 && stage.probe != problem.stages[s - 1].probe) borne.clear();
        if (!is_loaded(stage.action)) continue;
        const auto less = [&](const Action* then) { return !is_as_much(stage.action, *then); };
        if (std::ranges::any_of(borne, less)) return true;
        borne.push_back(&stage.action);
    }
    return false;
}

}  // namespace palpate::identify
