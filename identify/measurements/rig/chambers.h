#pragma once

#include "identify/measurements/measurement_set.h"

namespace palpate::identify {

/// Takes chambers out of the body whose walls are files of their own and that the rest surface does not show: their
/// walls become shells of it. What was carved is among the set's notes.
/// @throws InvalidInput for a chamber that reaches far out of the body, or lies in part outside of the material.
void carve_chambers(MeasurementSet& set);

}  // namespace palpate::identify
