#pragma once

#include <string>
#include <vector>

#include "identify/measurements/measurement_set.h"

namespace palpate::identify {

/// A part of a set that no model answers to yet.
struct UnfittedPart {
    std::string what;    // "tool 'ball'"
    std::string remedy;  // what this version fits, and what to do, without a full stop
};

/// Those of a set; empty: it can be fitted. The one place that decides: a part whose physics and likelihood have come
/// is taken out here.
std::vector<UnfittedPart> parts_not_fitted_yet(const MeasurementSet& set);

/// "tool 'ball', actuator 'cable': this version fits ...": all parts, and each remedy once.
std::string in_words(const std::vector<UnfittedPart>& parts);

/// @throws InvalidInput where there are such parts: a fit that ignored them would be wrong.
void require_fittable(const MeasurementSet& set);

/// Displacements that count from a state in which nothing is known to act (force, gravity, pressure, tool or actuator)
/// become positions from rest; others stay. The set's notes tell so.
void take_displacements_from_rest(MeasurementSet& set);

/// Noise that neighbours share becomes larger noise of each, so that their mean is known as well as it is: of n
/// readings of which each shares its noise with k the mean has the variance sigma^2 k / n. The set's notes tell so.
/// Nothing is done where the noise is not told.
void take_correlated_noise(MeasurementSet& set);

/// Does a set tell any force: of a contact, a tool, a pressure, a tension, or its weight? Without one, stiffness is
/// known up to a common factor.
bool tells_a_force(const MeasurementSet& set);

}  // namespace palpate::identify
