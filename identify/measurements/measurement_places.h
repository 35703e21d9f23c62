#pragma once

#include "identify/measurements/measurement_set.h"

namespace palpate::identify {

/// @throws InvalidInput when a contact or marker lies far off the rest surface: further than 5 % of the body's longest
/// side, beyond the radius of a contact, and outside the body for a marker. That is a wrong unit or frame.
void check_places(const MeasurementSet& set);

}  // namespace palpate::identify
