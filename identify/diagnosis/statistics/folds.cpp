#include "identify/diagnosis/statistics/folds.h"

#include <algorithm>
#include <set>

namespace palpate::identify {
namespace {

bool is_loaded(const LoadState& state) {
    return has_contact_force(state) || !state.motions.empty() || !state.actuations.empty();
}

}  // namespace

std::vector<std::vector<int>> folds_of(const MeasurementSet& set) {
    std::set<int> loaded, all;
    for (const LoadState& state : set.states) {
        if (is_loaded(state)) loaded.insert(state.probe);
        if (!state.readings.empty() || !state.reactions.empty()) all.insert(state.probe);
    }
    if (loaded.size() < 3) return {};
    if (loaded.size() > 8) {
        const std::vector<int> probes(loaded.begin(), loaded.end());
        const std::size_t count = probes.size() / 4;
        std::vector<int> held_out;
        for (std::size_t i = 0; i < count; ++i) held_out.push_back(probes[(2 * i + 1) * probes.size() / (2 * count)]);
        return {held_out};
    }
    std::vector<std::vector<int>> folds(3);
    for (std::size_t i = 0; const int probe : all) folds[i++ % folds.size()].push_back(probe);
    return folds;
}

MeasurementSet part_of(const MeasurementSet& set, const std::vector<int>& probes, bool of_them) {
    const auto is_other = [&](const LoadState& state) {
        return (std::ranges::find(probes, state.probe) != probes.end()) != of_them;
    };
    MeasurementSet part = set;
    for (LoadState& state : part.states) {
        if (!is_other(state)) continue;
        state.readings.clear();
        state.reactions.clear();
    }
    if (set.continuous) return part;  // the body went through all states, whoever reads them
    std::set<StateName> counted_from;
    for (const LoadState& state : part.states)
        for (const Reading& reading : state.readings)
            if (reading.since) counted_from.insert(*reading.since);
    std::erase_if(part.states, [&](const LoadState& state) {
        return is_other(state) && !counted_from.contains({state.probe, state.time});
    });
    return part;
}

}  // namespace palpate::identify
