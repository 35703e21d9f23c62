#pragma once

#include <vector>

#include "identify/measurements/measurement_set.h"
#include "skeleton/loads/load.h"

namespace palpate::identify {

/// The labelled readings of a state, tied to a skeleton.
struct StateReadings {
    int state = 0;             // in the set
    std::vector<int> rows;     // of the state's readings (m)
    std::vector<int> markers;  // of the set (m)
    skeleton::Load load;
    std::vector<skeleton::Attachment> points;  // where the markers hang (m)
    Points rest, measured;                     // (m x 3) [mm]; a missing coordinate is NaN
    Eigen::VectorXd noise;                     // 1 sigma of each (m) [mm], NaN when unknown
    int coordinates = 0;                       // that were measured
    double displacement = 0;                   // rms over them [mm]
    bool informs_stiffness = false;  // informative about stiffness: a force, gravity or an effect of the model acts
    int before = -1;                 // the state read last in the life of a body that yields, of those here
    std::vector<skeleton::Load> unmeasured;  // unmeasured loads since then, or since the virgin state
};

/// Where markers hang on a skeleton, one each.
std::vector<skeleton::Attachment> marker_attachments(const skeleton::Model& model, const std::vector<Marker>& markers);

class ContactLoads;

/// The labelled readings of one state of an elastic body, whatever the states before. `markers`: where the set's
/// markers hang; `set` tells what is known of all states. No rows where there is no such reading.
StateReadings read_state(const MeasurementSet& set, const LoadState& state, const ContactLoads& loads,
                         const std::vector<skeleton::Attachment>& markers, bool always_loaded);

/// A state each that has labelled readings, in the set's order; unlabelled readings are left out.
std::vector<StateReadings> collect_readings(const skeleton::Model& model, const MeasurementSet& set);

/// rms of the measured coordinates of a difference (m x 3), NaN being a missing one.
double rms(const Points& difference);

}  // namespace palpate::identify
