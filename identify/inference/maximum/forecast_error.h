#pragma once

#include "identify/measurements/measurement_set.h"

namespace palpate::identify {

/// How far a model is off under a probe that it was not fitted to, beyond the noise: so many mm rms are
/// `relative` times the root of u^2 + least_displacement^2, with u its rms displacement.
struct ForecastError {
    double relative = missing;      // rms over probes, each forecast from all others; NaN: not estimated
    double least_displacement = 0;  // [mm]
    int probes = 0;                 // that this was seen on
};

}  // namespace palpate::identify
