#include "identify/measurements/rig/fittable.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "identify/loading/loads.h"
#include "mesh/errors.h"

namespace palpate::identify {
namespace {

int count_of_differences(const MeasurementSet& set) {
    int count = 0;
    for (const LoadState& state : set.states)
        count += static_cast<int>(
            std::ranges::count_if(state.readings, [](const Reading& reading) { return reading.since.has_value(); }));
    return count;
}

bool acts_with_force(const MeasurementSet& set, const Actuation& actuation) {
    const auto* tendon =
        std::get_if<mesh::TendonActuator>(&set.actuators[static_cast<std::size_t>(actuation.actuator)].kind);
    return actuation.value != 0 && !(tendon && tendon->by_length);
}

}  // namespace

std::vector<UnfittedPart> parts_not_fitted_yet(const MeasurementSet& set) {
    std::vector<UnfittedPart> parts;
    if (const int differences = count_of_differences(set); differences > 0)
        parts.push_back({fmt::format("{} displacements since a state in which something acts", differences),
                         "displacements are fitted as positions. Let them count from an unloaded state "
                         "('displacements.since' in set.yaml), or from rest"});
    if (set.position_correlation)
        parts.push_back({fmt::format("'correlated.position' ({:.4g} mm)", *set.position_correlation),
                         "each reading's noise is taken for its own. Take 'correlated' out, and keep one marker for "
                         "each such length rather than all, so that none counts twice"});
    return parts;
}

std::string in_words(const std::vector<UnfittedPart>& parts) {
    std::vector<std::string> names, remedies;
    for (const UnfittedPart& part : parts) {
        names.push_back(part.what);
        if (std::ranges::find(remedies, part.remedy) == remedies.end()) remedies.push_back(part.remedy);
    }
    return fmt::format("{}: {}", fmt::join(names, ", "), fmt::join(remedies, ". Also, "));
}

void require_fittable(const MeasurementSet& set) {
    const std::vector<UnfittedPart> parts = parts_not_fitted_yet(set);
    if (!parts.empty())
        throw InvalidInput(fmt::format("set '{}': it cannot be fitted yet with {}.", set.name, in_words(parts)));
}

void take_displacements_from_rest(MeasurementSet& set) {
    int taken = 0;
    for (LoadState& state : set.states)
        for (Reading& reading : state.readings) {
            if (!reading.since) continue;
            const LoadState* reference = find_state(set, *reading.since);
            if (!reference || is_known_to_act(set, *reference)) continue;
            reading.since.reset();
            ++taken;
        }
    if (taken > 0)
        set.notes.push_back(
            fmt::format("{} displacements count from a state in which nothing is known to act: they are taken as "
                        "positions, from rest.",
                        taken));
}

bool tells_a_force(const MeasurementSet& set) {
    return std::ranges::any_of(set.states, [&](const LoadState& state) {
        const bool is_heavy = set.density && !known_gravity(set, state).value_or(Vec3::Zero()).isZero(0);
        const bool pushed =
            std::ranges::any_of(state.contacts, [](const mesh::Contact& c) { return !c.force.isZero(0); });
        return is_heavy || pushed || known_pressure(state) != 0 || !state.reactions.empty() ||
               std::ranges::any_of(state.actuations,
                                   [&](const Actuation& actuation) { return acts_with_force(set, actuation); });
    });
}

}  // namespace palpate::identify
