#include "identify/loading/readings.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "identify/loading/creep.h"
#include "identify/loading/loads.h"
#include "skeleton/model/attachment/attach.h"

namespace palpate::identify {

std::vector<skeleton::Attachment> marker_attachments(const skeleton::Model& model, const std::vector<Marker>& markers) {
    std::vector<skeleton::Attachment> points;
    points.reserve(markers.size());
    const skeleton::Attacher attach(model);
    for (const Marker& marker : markers) {
        points.push_back(attach(marker.anchor.value_or(marker.rest), marker.rest));
    }
    return points;
}

double rms(const Points& difference) {
    double sum = 0;
    int count = 0;
    for (const double d : difference.reshaped()) {
        if (std::isnan(d)) continue;
        sum += d * d;
        ++count;
    }
    return count > 0 ? std::sqrt(sum / count) : 0;
}

StateReadings read_state(const MeasurementSet& set, const LoadState& state, const ContactLoads& loads,
                         const std::vector<skeleton::Attachment>& markers, bool always_loaded) {
    StateReadings readings;
    for (int row = 0; row < static_cast<int>(state.readings.size()); ++row) {
        if (is_usable(state.readings[row])) readings.rows.push_back(row);
    }
    const auto m = static_cast<Eigen::Index>(readings.rows.size());
    readings.rest.resize(m, 3);
    readings.measured.resize(m, 3);
    readings.noise.resize(m);
    for (Eigen::Index i = 0; i < m; ++i) {
        const Reading& reading = state.readings[readings.rows[i]];
        readings.markers.push_back(reading.marker);
        readings.points.push_back(markers[reading.marker]);
        readings.rest.row(i) = set.markers[reading.marker].rest;
        readings.measured.row(i) = reading.position;
        readings.noise[i] = std::isnan(reading.sigma) ? set.position_noise.value_or(missing) : reading.sigma;
    }
    readings.coordinates = static_cast<int>((!readings.measured.array().isNaN()).count());
    readings.displacement = rms(readings.measured - readings.rest);
    readings.load = loads(set, state);
    readings.informs_stiffness = always_loaded || is_known_to_act(set, state);
    return readings;
}

std::vector<StateReadings> collect_readings(const skeleton::Model& model, const MeasurementSet& set) {
    const std::optional<fem::CreepLaw> creep = skeleton::physics_of(model.effects).creep;
    const MeasurementSet elastic_set = creep ? as_elastic(set, *creep) : set;
    const std::vector<skeleton::Attachment> markers = marker_attachments(model, set.markers);
    const ContactLoads loads(model);
    const bool remembers = skeleton::physics_of(model.effects).remember();
    const bool always_loaded = is_always_loaded(model) || remembers;
    std::vector<StateReadings> result;
    struct ProbeHistory {
        int last = -1;
        std::vector<skeleton::Load> since;
    };
    std::map<int, ProbeHistory> histories;  // of each probe; of a body that goes through all of them one

    for (int s = 0; s < static_cast<int>(set.states.size()); ++s) {
        const LoadState& state = set.states[s];
        StateReadings readings = read_state(set, state, loads, markers, always_loaded);
        readings.state = s;
        ProbeHistory& history = histories[set.continuous ? 0 : state.probe];
        if (readings.rows.empty()) {
            if (remembers) history.since.push_back(loads(elastic_set, elastic_set.states[s]));
            continue;
        }
        if (remembers) {
            readings.before = history.last;
            readings.unmeasured = std::move(history.since);
            history = {.last = static_cast<int>(result.size()), .since = {}};
        }
        if (creep) readings.load = loads(elastic_set, elastic_set.states[s]);
        result.push_back(std::move(readings));
    }
    return result;
}

}  // namespace palpate::identify
