#pragma once

#include "identify/measurements/measurement_set.h"

namespace palpate::identify {

/// What one unit of the files is in ours.
struct SetUnits {
    double length = 1;  // [mm]
    double force = 1;   // [N]
};

/// Reads set.yaml, and the surface and support points that it names, into `set`: all but markers and states.
SetUnits read_set_description(const std::filesystem::path& file, MeasurementSet& set);

}  // namespace palpate::identify
