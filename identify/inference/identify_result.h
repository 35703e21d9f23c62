#pragma once

#include <optional>
#include <string>
#include <vector>

#include "identify/inference/maximum/forecast_error.h"
#include "identify/inference/particles/filter_step.h"
#include "identify/inference/posterior_row.h"
#include "identify/measurements/measurement_set.h"
#include "identify/motion/damping_result.h"
#include "mesh/types.h"
#include "skeleton/model/model.h"

namespace palpate::identify {

/// A maximum of the posterior.
struct Mode {
    double probability = 1;
    Eigen::VectorXd stiffness;  // there, of each parameter, units as in the posterior
};

/// Of the logarithms of two parameters' stiffness, in the posterior.
struct Correlation {
    int a = 0, b = 0;  // rows of the posterior, a < b
    double value = 0;
};

/// Range of the measurements, beyond which the model extrapolates.
struct MeasuredRange {
    double force = 0;          // the largest of one contact [N]
    double displacement = 0;   // the largest of a marker [mm]
    std::vector<Vec3> places;  // that were touched
};

struct IdentifyResult {
    skeleton::Model model;                  // with the law and the most probable stiffness; burion2008: the mean
    std::vector<PosteriorRow> posterior;    // a row per parameter
    Eigen::VectorXd best;                   // the particle of highest weight (parameters)
    std::vector<Mode> modes;                // the most probable one first; none by burion2008
    std::vector<Correlation> correlations;  // of 0.7 and more, the strongest first, at most 100
    std::vector<FilterStep> history;
    std::vector<double> fit_trace;  // -ln density, but for a constant, at the start and after each step of the last fit
    double model_error = missing;   // of a prediction, beyond the noise, over its displacement; NaN: not estimated
    ForecastError forecast_error;
    MeasuredRange measured;
    std::optional<DampingResult> damping;  // for identify_damping to fill
    int states = 0, coordinates = 0;       // that were weighed
    double log_evidence = 0;
    double log_evidence_sd = missing;  // by how much it may be off; NaN: not estimated
    double effective_samples = 0;      // independent draws that the particles are worth
    double r_hat = missing;            // of two independent clouds of particles, 1: they agree; NaN: there is but one
    double acceptance = 0;             // of the moves
    int equilibria = 0;                // solved
    std::vector<std::string> notes;    // what a user should know, in words
};

}  // namespace palpate::identify
