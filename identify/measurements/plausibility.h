#pragma once

#include <string>
#include <vector>

#include "identify/measurements/measurement_set.h"

namespace palpate::identify {

/// Warnings about likely unit or frame errors in a set, with the probable cause; empty if plausible: a body of another
/// size than is pressed by hand or rig, markers that all lie in one spot of it, or were read further from where they
/// rest than it is long, forces that no solid would answer so.
std::vector<std::string> implausible(const MeasurementSet& set);

/// What hints at a slip of units in a body's longest side [mm], in words; else empty.
std::string implausible_size(double longest);

/// The same of a Young's modulus that fits [MPa]: beyond any solid, or 300 times off what the set says; else empty.
std::string implausible_modulus(double young, const MeasurementSet& set);

}  // namespace palpate::identify
