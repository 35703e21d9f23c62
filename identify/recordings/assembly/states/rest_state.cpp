#include "identify/recordings/assembly/states/rest_state.h"

#include <fmt/format.h>

#include <algorithm>

#include "mesh/errors.h"

namespace palpate::identify {
namespace {

const ProbeStates& probe_at_rest(const ImportMap& map, const std::vector<ProbeStates>& probes) {
    if (!map.rest_probe) {
        const auto with_points =
            std::ranges::find_if(probes, [](const ProbeStates& probe) { return !probe.probe->points.empty(); });
        return with_points == probes.end() ? probes.front() : *with_points;
    }
    const auto found =
        std::ranges::find_if(probes, [&](const ProbeStates& probe) { return probe.probe->probe == *map.rest_probe; });
    if (found == probes.end())
        throw InvalidInput(fmt::format("{}: rest: there is no probe {}. Name one of 'files'.",
                                       map.file.filename().string(), *map.rest_probe));
    return *found;
}

}  // namespace

void add_places_at_rest(const Recording& recording, PlacesOfFiles& places) {
    for (const RecordedPoint& point : recording.points)
        for (Eigen::Index f = 0; f < point.displacement.cols(); ++f) {
            if (!point.at.col(f).allFinite() || !point.displacement.col(f).allFinite()) continue;
            places.at.try_emplace(point.name, point.at.col(f) - point.displacement.col(f));
            places.has_moved = places.has_moved || (f == 0 && !point.displacement.col(f).isZero(0));
            break;
        }
}

RestState rest_state(const ImportMap& map, const std::vector<ProbeStates>& probes, const PlacesOfFiles& places,
                     std::vector<std::string>& notes) {
    const ProbeStates& probe = probe_at_rest(map, probes);
    RestState rest{.probe = probe.probe, .state = probe.states.front()};
    if (map.is_rest_of_files.value_or(false) && places.at.empty())
        throw InvalidInput(fmt::format(
            "{}: rest: no file tells displacements, so none tells where its points rest. Say 'first', 'none', or the "
            "number of a probe.",
            map.file.filename().string()));
    // Where the first frame is the reference itself, it is a reading with its noise, as others are.
    rest.is_of_files = map.is_rest_of_files.value_or(places.has_moved);
    if (!rest.is_of_files) return rest;
    std::size_t told = 0;
    for (std::size_t p = 0; p < rest.state.points.size(); ++p) {
        const auto place = places.at.find(rest.probe->points[p].name);
        if (place == places.at.end()) continue;
        rest.state.points[p] = {.at = place->second, .sigma = 0, .samples = 1};
        ++told;
    }
    notes.push_back(
        fmt::format("At rest {} points are where their displacements count from, as the files tell; 'rest: "
                    "first' in a map takes the first state.",
                    told));
    return rest;
}

}  // namespace palpate::identify
