#pragma once

#include <string>
#include <vector>

#include "identify/inference/maximum/fit_map.h"
#include "identify/inference/problem/identify_options.h"
#include "identify/loading/readings.h"
#include "mesh/progress.h"

namespace palpate::identify {

/// One multiplier a kind of stiffness, and what goes with it.
struct UniformFit {
    skeleton::EquilibriumLaw law;
    Eigen::VectorXd theta;             // (kinds)
    Eigen::Matrix<double, 6, 1> dent;  // amplitudes [1/MPa]
    double model_error = 0;            // rel of the domain
    double chi_squared = 0;            // that is left
};

/// The most probable stiffnesses in the position domain, and what the particles need to know.
struct Calibration {
    PositionDomain domain;  // with its model error set
    LogNormalPrior prior;
    FitResult fit;
    std::vector<FitResult> others;  // lower maxima of the posterior, or equal ones, see find_modes
    UniformFit coarse;              // on the way
    double model_error = 0;         // rel of the domain
    int equilibria = 0;             // solved
    std::vector<std::string> notes;
};

/// Fits stiffness to measured positions, from coarse to fine:
/// 1. a first look at the most displaced states: one multiplier a kind of stiffness, round the common factor that fits
///    best (closed form), sd of ln 3; under both laws, where it is to be chosen: smaller chi^2 wins. After each fit,
///    here and below, the dents round contacts that explain most of what is left (linear least squares);
/// 2. the same on all states, with the model error that the first look left;
/// 3. zones: likewise, sd of ln 3; links: round the uniform fit, sd of ln 0.7, alike where links meet, so that those
///    that are unobserved follow their neighbours; again with the model error that a fit left, as long as that
///    falls. A model that could follow the measurements is taken at its word only when it does.
/// `near`: the uniform fit to other readings of the same model, in place of the first look.
/// @pre some readings are informative about stiffness.
Calibration calibrate(const skeleton::Model& model, const std::vector<StateReadings>& readings,
                      const IdentifyOptions& options, const Progress& progress, const UniformFit* near = nullptr);

/// The model with the most probable stiffnesses, and with the law and the dents found beside them.
skeleton::Model calibrated(const skeleton::Model& model, const Calibration& calibration);

}  // namespace palpate::identify
