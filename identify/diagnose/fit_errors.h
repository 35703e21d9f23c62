#pragma once

#include <optional>

#include "identify/compare.h"
#include "identify/diagnose/refit.h"
#include "identify/where.h"

namespace palpate::identify {

/// How a fit errs, told as a comparison is.
struct FitErrors {
    double rms = 0, max = 0;    // [mm]; max: of the error vectors' lengths
    double relative = missing;  // rms over rms displacement
    double whitened_rms = 0;    // in sigmas of noise and of what nobody can know
    double left = 0;            // mean square beyond what nobody can know [mm^2]
    double unsure = 0;          // size of what nobody can know, rms [mm]
    std::optional<LoadExponent> load_exponent;
    Where where;  // by what the nuisances do not explain either
};

/// What nobody can know about contacts and clamps counts at its size before the fit: bent to the readings of a model
/// that lacks physics, it would swallow most of what is missing.
FitErrors errors_of(const Problem& problem, const Refit& fit);

/// Mean square error of predictions for the readings of a problem [mm^2]: readings that were set aside do not count.
double mean_square_error(const Problem& problem, const MeasurementSet& set, const Comparison& comparison);

}  // namespace palpate::identify
