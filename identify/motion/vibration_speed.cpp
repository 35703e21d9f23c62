#include "identify/motion/vibration_speed.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "identify/loading/loads.h"

namespace palpate::identify {
namespace {

/// Does weight act, in the model or in the set? Masses have to stay then.
bool weighs(const skeleton::Model& model, const MeasurementSet& set) {
    const auto known = [&](const LoadState& state) {
        return !known_gravity(set, state).value_or(Vec3::Zero()).isZero(0);
    };
    const auto pulls = [](const auto& potential) { return potential->acts_on() == fem::ActsOn::material; };
    return std::ranges::any_of(skeleton::physics_of(model.effects).points, pulls) ||
           std::ranges::any_of(set.states, known);
}

}  // namespace

void match_vibration_speed(skeleton::Model& model, const MeasurementSet& set, DampingResult& result) {
    constexpr double worth_telling = 0.03;  // of the speed, 6 % of stiffness or mass: a choice
    const double speed = result.speed.q50;
    if (!result.speed.informed || std::abs(speed - 1) < worth_telling) return;
    if (!set.density && !weighs(model, set)) {
        result.mass = 1 / (speed * speed);
        for (skeleton::Sphere& sphere : model.spheres) {
            sphere.mass *= result.mass;
            sphere.inertia *= result.mass;
        }
        result.notes.push_back(
            fmt::format("The set tells no density: the model's masses were multiplied by {:.3g}, so "
                        "that it vibrates as fast as the body.",
                        result.mass));
        return;
    }
    // as fast as it is, the model is to die away in as many cycles
    result.damping.alpha /= speed;
    result.damping.beta *= speed;
    result.notes.push_back(
        fmt::format("The body vibrates {:.3g} times as fast as the model: in motion it is {:.2g} times as stiff as at "
                    "rest, or its density is {:.2g} times what was told.",
                    speed, speed * speed, 1 / (speed * speed)));
}

}  // namespace palpate::identify
