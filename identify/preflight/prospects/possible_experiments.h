#pragma once

#include <string>
#include <vector>

#include "identify/effects/effect.h"
#include "identify/measurements/measurement_set.h"
#include "identify/models/body_model.h"

namespace palpate::identify {

/// More states for a set, as a rig could bring them within an hour.
struct Experiment {
    /// unload (the unloaded pose), levels, repeat, orientation, load, dwell, release (a load removed), pressure. The
    /// "unload" of a diagnosis, `probe_kinds::load_removed`, is "release" here.
    std::string kind;
    std::string words;                             // what to do, as an order
    std::vector<LoadState> states = {};            // without readings
    std::vector<ProbeConditions> conditions = {};  // of each state
};

/// Those that the set lacks: the unloaded pose, the body turned, every probe at one and two thirds of its load and once
/// more, presses at other places, the strongest load held, or taken off, vented cavities. Loads, tools and actuators
/// are the set's own.
std::vector<Experiment> possible_experiments(const BodyModel& model, const MeasurementSet& set, const Problem& problem);

}  // namespace palpate::identify
