#pragma once

#include "identify/identify.h"

namespace palpate::identify {

struct LabelledSet {
    MeasurementSet set;
    int matched = 0, left_out = 0;  // readings that came without a label
};

/// Names the markers of readings that came without, by where the model says that each marker is: a reading and a free
/// marker that are next to each other, both ways, and twice as near as the second best, and no further apart than the
/// markers of that state move. Then the stiffness is fitted, one multiplier a kind, and the rest is looked at again,
/// until no label changes. What stays without a label is left out.
LabelledSet label_readings(const skeleton::Model& model, const MeasurementSet& set, const IdentifyOptions& options);

}  // namespace palpate::identify
