#pragma once

#include <string>
#include <vector>

#include "identify/fit/fit.h"
#include "identify/identify.h"

namespace palpate::identify {

/// The most probable stiffnesses in the position domain, and what the particles need to know.
struct Calibration {
    PositionDomain domain;  // with its model error set
    LogNormalPrior prior;
    FitResult fit;
    double model_error = 0;  // rel of the domain
    int equilibria = 0;      // solved
    std::vector<std::string> notes;
};

/// Fits stiffness to measured positions, from coarse to fine:
/// 1. the law, where it is to be chosen: a uniform fit under both, smaller chi^2 wins;
/// 2. one multiplier a kind of stiffness, round the common factor that fits best (closed form), sd of ln 3; twice, as
///    the first fit tells the model error of the second; after each fit, here and below, the dents round contacts that
///    explain most of what is left (linear least squares);
/// 3. zones: likewise, sd of ln 3; links: round the uniform fit, sd of ln 0.7; again twice.
/// @pre some of the readings tell about stiffness.
Calibration calibrate(const skeleton::Model& model, const std::vector<StateReadings>& readings,
                      const IdentifyOptions& options, const Progress& progress);

/// The model with the most probable stiffnesses, and with the law and the dents found beside them.
skeleton::Model calibrated(const skeleton::Model& model, const Calibration& calibration);

}  // namespace palpate::identify
