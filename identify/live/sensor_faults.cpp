#include "identify/live/sensor_faults.h"

#include <fmt/format.h>

#include <cmath>

namespace palpate::identify {
namespace {

constexpr int stuck_after = 2;  // the same position under another load

}  // namespace

std::optional<std::string> SensorFaults::find(LoadState& reading, const std::set<StateName>& seen,
                                              std::string& mended) {
    const StateName name{reading.probe, reading.time};
    if (seen.contains(name)) return "was there already";
    const auto add = [&](const std::string& words) { mended += (mended.empty() ? "" : "; ") + words; };
    const auto later = seen.upper_bound(name);
    if (later != seen.end() && later->probe == name.probe) add("out of order");

    Vec3 load = Vec3::Zero();
    for (const mesh::Contact& contact : reading.contacts) {
        if (!contact.force.allFinite() || !contact.point.allFinite()) return "has a force that is no number";
        load += contact.force;
    }
    int infinite = 0, stuck = 0;
    for (Reading& own : reading.readings) {
        if (own.marker < 0 || own.marker >= static_cast<int>(last_.size())) continue;
        for (double& coordinate : own.position) {
            if (!std::isinf(coordinate)) continue;
            coordinate = missing;
            ++infinite;
        }
        Stuck& last = last_[own.marker];
        const bool same = own.position.allFinite() && own.position == last.position && load != last.load;
        last.times = same ? last.times + 1 : 0;
        last.position = own.position;
        last.load = load;
        if (last.times < stuck_after) continue;
        own.position.setConstant(missing);
        ++stuck;
    }
    if (infinite > 0) add(fmt::format("{} infinite coordinates count as missing", infinite));
    if (stuck > 0) add(fmt::format("{} markers are stuck where they were and are left out", stuck));
    return std::nullopt;
}

}  // namespace palpate::identify
