#include "identify/identify.h"

#include <algorithm>

#include "identify/diagnosis/rigged/rigged_skeleton.h"
#include "identify/inference/methods/methods.h"
#include "identify/measurements/field.h"
#include "identify/measurements/labels/label_readings.h"

namespace palpate::identify {

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
    if (is_rigged(readable)) {
        result = identify_rigged(model, readable, options, progress);
    } else if (options.method == Method::burion2008) {
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
