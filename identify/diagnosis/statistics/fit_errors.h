#pragma once

#include <optional>

#include "identify/comparison/comparison.h"
#include "identify/comparison/error_location.h"
#include "identify/comparison/load_exponent.h"
#include "identify/diagnosis/fit/refit.h"

namespace palpate::identify {

/// How a fit errs, told as a comparison is.
struct FitErrors {
    double rms = 0, max = 0;    // of the positions [mm]; max: of the error vectors' lengths
    double rms_n = missing;     // of the forces of tools; NaN where there are none
    double relative = missing;  // rms over rms displacement; of the forces where no position moved
    double whitened_rms = 0;    // in sigmas of noise and nuisances
    double left = 0;            // mean square beyond the nuisances [mm^2]
    double nuisance_sd = 0;     // size of the nuisances, rms [mm]
    std::optional<LoadExponent> load_exponent;
    ErrorLocations where;  // by what the nuisances do not explain either
};

/// Nuisances of contacts and clamps count at their size before the fit: bent to the readings of a model
/// that lacks physics, it would swallow most of what is missing.
FitErrors errors_of(const Problem& problem, const Refit& fit);

/// Mean square error of predictions for the readings of a problem [mm^2]: readings that were set aside do not count.
double mean_square_error(const Problem& problem, const MeasurementSet& set, const Comparison& comparison);

}  // namespace palpate::identify
