#include "identify/measurements/measurement_set.h"

#include <algorithm>

namespace palpate::identify {

std::string label_of(const Marker& marker) { return marker.name.empty() ? std::to_string(marker.id) : marker.name; }

bool needs_second_format(const MeasurementSet& set) {
    const auto is_difference = [](const Reading& reading) { return reading.since.has_value(); };
    return !set.tools.empty() || !set.actuators.empty() || !set.regions.empty() || set.reaction_noise ||
           set.moment_noise || set.position_correlation || std::ranges::any_of(set.states, [&](const LoadState& state) {
               return std::ranges::any_of(state.readings, is_difference);
           });
}

const LoadState* find_state(const MeasurementSet& set, const StateName& name) {
    const auto found = std::ranges::find_if(set.states, [&](const LoadState& state) {
        return StateName{state.probe, state.time} == name;
    });
    return found == set.states.end() ? nullptr : &*found;
}

}  // namespace palpate::identify
