#pragma once

#include <vector>

#include "identify/measurements/measurement_set.h"

namespace palpate::identify {

/// Which probes are held out, in turn.
///
/// A quarter of the loaded ones, spread evenly, where there are more than eight; the steps of a ladder are fitted to
/// the others. Of fewer none can be spared: every third probe is held out in turn, and the steps are fitted to all.
std::vector<std::vector<int>> folds_of(const MeasurementSet& set);

/// The readings of these probes, or of all but these; of what nobody reads then, states stay that readings are counted
/// from, and all states of one continuous history.
MeasurementSet part_of(const MeasurementSet& set, const std::vector<int>& probes, bool of_them);

}  // namespace palpate::identify
