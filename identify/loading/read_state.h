#pragma once

#include "identify/loading/loads.h"
#include "identify/loading/readings.h"

namespace palpate::identify {

/// The labelled readings of one state of an elastic body, whatever the states before. `markers`: where the set's
/// markers hang; `set` tells what is known of all states. No rows where there is no such reading.
StateReadings read_state(const MeasurementSet& set, const LoadState& state, const ContactLoads& loads,
                         const std::vector<skeleton::Attachment>& markers, bool always_loaded);

}  // namespace palpate::identify
