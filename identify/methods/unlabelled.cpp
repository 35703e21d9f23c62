#include "identify/methods/unlabelled.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "identify/compare.h"
#include "identify/fit/calibrate.h"
#include "identify/set/readings.h"
#include "mesh/errors.h"

namespace palpate::identify {
namespace {

constexpr int most_rounds = 6;
constexpr double clearly = 0.5;  // of the distance to the second best
constexpr double nobody = std::numeric_limits<double>::infinity();

/// The set with all markers that a state has not labelled, in every state that has unlabelled readings.
MeasurementSet asked_for(const MeasurementSet& set) {
    MeasurementSet asked = set;
    for (LoadState& state : asked.states) {
        std::vector<char> is_labelled(set.markers.size(), 0);
        bool is_open = false;
        for (const Reading& reading : state.readings) {
            if (reading.marker >= 0) is_labelled[reading.marker] = 1;
            is_open = is_open || reading.marker < 0;
        }
        state.readings.clear();
        for (int m = 0; is_open && m < static_cast<int>(set.markers.size()); ++m) {
            if (is_labelled[m] == 0) state.readings.push_back({m, set.markers[m].rest, missing});
        }
    }
    return asked;
}

/// Over the measured coordinates; one that is missing all three is nowhere.
double distance(const Vec3& measured, const Vec3& modelled) {
    const Eigen::Array3d difference = (measured - modelled).array();
    if (difference.isNaN().all()) return nobody;
    return std::sqrt(difference.isNaN().select(0, difference).square().sum());
}

struct Nearest {
    int index = -1;
    double first = nobody, second = nobody;

    void meet(int candidate, double at) {
        if (at < first) {
            second = std::exchange(first, at);
            index = candidate;
        } else {
            second = std::min(second, at);
        }
    }
    bool is_clear() const { return index >= 0 && first < clearly * second; }
};

/// Gives labels to readings of one state; `where` the model says that the free markers `asked` are.
void match(const std::vector<Reading>& asked, const Points& where, LoadState& state) {
    double moved = 0;
    for (std::size_t m = 0; m < asked.size(); ++m) {
        moved = std::max(moved, (where.row(static_cast<Eigen::Index>(m)).transpose() - asked[m].position).norm());
    }
    std::vector<Nearest> of_reading(state.readings.size()), of_marker(asked.size());
    for (std::size_t r = 0; r < state.readings.size(); ++r) {
        if (state.readings[r].marker >= 0) continue;
        for (std::size_t m = 0; m < asked.size(); ++m) {
            const double d = distance(state.readings[r].position, where.row(static_cast<Eigen::Index>(m)).transpose());
            of_reading[r].meet(static_cast<int>(m), d);
            of_marker[m].meet(static_cast<int>(r), d);
        }
    }
    for (std::size_t r = 0; r < state.readings.size(); ++r) {
        const Nearest& marker = of_reading[r];
        if (!marker.is_clear() || marker.first > moved || !of_marker[marker.index].is_clear()) continue;
        if (of_marker[marker.index].index == static_cast<int>(r)) state.readings[r].marker = asked[marker.index].marker;
    }
}

std::vector<int> labels(const MeasurementSet& set) {
    std::vector<int> all;
    for (const LoadState& state : set.states) {
        for (const Reading& reading : state.readings) all.push_back(reading.marker);
    }
    return all;
}

/// The model with one multiplier a kind fitted to what has labels, as far as that tells something.
skeleton::Model fitted(const skeleton::Model& model, const MeasurementSet& set, IdentifyOptions options) {
    const std::vector<StateReadings> readings = collect_readings(model, set);
    if (std::ranges::none_of(readings, &StateReadings::tells_stiffness)) return model;
    options.scope = Scope::uniform;
    try {
        return calibrated(model, calibrate(model, readings, options, {}));
    } catch (const SolverFailure&) {  // wrong labels
        return model;
    }
}

}  // namespace

LabelledSet label_readings(const skeleton::Model& model, const MeasurementSet& set, const IdentifyOptions& options) {
    LabelledSet result{set, 0, 0};
    const auto unlabelled = std::ranges::count(labels(set), -1);
    if (unlabelled == 0) return result;
    result.left_out = static_cast<int>(unlabelled);
    const MeasurementSet asked = asked_for(set);
    if (std::ranges::all_of(asked.states, [](const LoadState& s) { return s.readings.empty(); })) return result;
    for (int round = 0; round < most_rounds; ++round) {
        const Comparison modelled = compare(fitted(model, result.set, options), asked, options.threads);
        MeasurementSet next = set;
        for (std::size_t s = 0; s < set.states.size(); ++s) {
            match(asked.states[s].readings, modelled.predicted[s], next.states[s]);
        }
        const bool settled = labels(next) == labels(result.set);
        result.set = std::move(next);
        if (settled) break;
    }
    result.left_out = static_cast<int>(std::ranges::count(labels(result.set), -1));
    result.matched = static_cast<int>(unlabelled) - result.left_out;
    return result;
}

}  // namespace palpate::identify
