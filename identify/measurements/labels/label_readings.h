#pragma once

#include "identify/measurements/measurement_set.h"

namespace palpate::identify {

struct LabelledSet {
    MeasurementSet set;
    int matched = 0, left_out = 0;  // readings that came without a label
};

/// Names the markers of readings that came without: in each state the markers drift from where they rest to where they
/// were read, all moving as one smooth field (coherent_drift), whatever made them move; a reading is of the marker that
/// has come to it, if that is clear: nine times as probable as all others together, and no other reading's. Labelled
/// readings lead the way. What stays unclear, and readings of less than three coordinates that have two markers near,
/// stay without a label.
LabelledSet label_readings(const MeasurementSet& set);

/// What was done, in words; empty where all readings had labels.
std::vector<std::string> notes(const LabelledSet& labelled);

}  // namespace palpate::identify
