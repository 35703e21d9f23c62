#pragma once

#include <string>
#include <vector>

#include "identify/diagnosis/fit/refit.h"
#include "identify/measurements/measurement_set.h"

namespace palpate::identify {

/// Does a set tell the noise of all its readings of positions?
bool tells_noise(const MeasurementSet& set);

/// Sets the sigmas that the set does not tell from the roughness of a fit's errors; at least `resolution` of `moved`,
/// the readings from rest, rms [mm]. `notes` says which of the two it is, in place of what an earlier estimate said.
void estimate_noise_from(const Refit& fit, double moved, double resolution, Problem& problem,
                         std::vector<std::string>& notes);

}  // namespace palpate::identify
