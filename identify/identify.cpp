#include "identify/identify.h"

#include <fmt/format.h>

#include <algorithm>

#include "identify/inference/methods/methods.h"
#include "identify/measurements/field.h"
#include "identify/measurements/labels/label_readings.h"
#include "mesh/errors.h"

namespace palpate::identify {

void IdentifyOptions::validate() const {
    const auto demand = [](bool holds, const char* option, double value, const char* allowed) {
        if (!holds) throw InvalidInput(fmt::format("option {} is {}; it must be {}", option, value, allowed));
    };
    demand(particles == 0 || particles >= 10, "particles", particles, "0 (by the method) or at least 10");
    demand(iterations >= 1, "iterations", iterations, "at least 1");
    demand(search_low > 0, "search_low", search_low, "above 0");
    demand(search_high > search_low, "search_high", search_high, "above search_low");
    demand(threads >= 1, "threads", threads, "at least 1");
}

namespace {

MeasuredRange range_of(const MeasurementSet& set) {
    MeasuredRange range;
    for (const LoadState& state : set.states) {
        for (const mesh::Contact& contact : state.contacts) {
            if (contact.force.isZero(0)) continue;
            range.force = std::max(range.force, contact.force.norm());
            const bool known = std::ranges::any_of(range.places, [&](const Vec3& p) { return p == contact.point; });
            if (!known) range.places.push_back(contact.point);
        }
        for (const Reading& reading : state.readings) {
            if (reading.marker < 0 || !reading.position.allFinite()) continue;
            range.displacement =
                std::max(range.displacement, (reading.position - set.markers[reading.marker].rest).norm());
        }
    }
    return range;
}

}  // namespace

IdentifyResult identify(const skeleton::Model& model, const MeasurementSet& set, const IdentifyOptions& options,
                        const Progress& progress, const UniformFit* near) {
    options.validate();
    const LabelledSet labelled = label_readings(with_markers_of_fields(set));
    const MeasurementSet& readable = labelled.set;
    IdentifyResult result;
    if (options.method == Method::burion2008) {
        result = identify_burion2008(model, readable, options, progress);
    } else if (options.domain == Domain::force) {
        result = identify_by_forces(model, readable, options, progress);
    } else {
        result = identify_tempered(model, readable, options, progress, near);
    }
    result.measured = range_of(readable);
    for (const std::string& note : notes(labelled)) result.notes.push_back(note);
    return result;
}

}  // namespace palpate::identify
