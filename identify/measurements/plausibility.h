#pragma once

#include <string>
#include <vector>

#include "identify/measurements/measurement_set.h"

namespace palpate::identify {

/// Warnings about likely unit or frame errors in a set, with the probable cause; empty if plausible: a body
/// smaller than 0.1 mm or longer than 100 m, markers read further from where they rest than the body is long, forces
/// that no solid would answer so.
std::vector<std::string> implausible(const MeasurementSet& set);

/// The same of a Young's modulus that fits [MPa]: beyond any solid, or 300 times off what the set says; else empty.
std::string implausible_modulus(double young, const MeasurementSet& set);

}  // namespace palpate::identify
