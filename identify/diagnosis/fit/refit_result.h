#pragma once

#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "identify/diagnosis/fit/explanation.h"
#include "identify/diagnosis/likelihood/nuisances.h"
#include "identify/diagnosis/likelihood/whitening.h"

namespace palpate::identify {

/// An explanation fitted to a problem, with all that the statistics need.
struct Refit {
    Explanation explanation;
    std::vector<std::vector<EffectNumber>> numbers;  // of each effect
    ForwardSolution forward;
    Eigen::VectorXd error;    // d = (measured - modelled) / sigma (N)
    Eigen::MatrixXd columns;  // d modelled / d numbers, over sigma (N x numbers)
    Nuisances nuisances;
    std::optional<Whitening> V;            // of nuisances and weights
    Eigen::VectorXd prior_mean, prior_sd;  // of all numbers
    bool has_known_magnitude = false;      // an effect's numbers have the magnitude that is known
    Eigen::MatrixXd covariance;            // of all numbers, posterior
    Eigen::MatrixXd scatter;               // of the same, as probes disagree and the mesh errs
    double log_evidence = 0;               // less the constant that the readings share
    int steps = 0;                         // Gauss-Newton's
    bool converged = false;

    double rms_mm = 0;                 // over all measured coordinates
    double rms_n = missing;            // over all measured forces of tools; NaN where there are none
    double whitened_rms = 0;           // in sigmas of noise and nuisances: 1 is as good as it gets
    double nuisance_pull = 0;          // of the most strained nuisance, in its prior sd
    std::string most_pulled_nuisance;  // its name
    Eigen::VectorXd residual;          // what the nuisances do not explain either, in sigmas (N)
};

/// How much an effect's known magnitude counts, as that of gravity on earth.
enum class MagnitudeUse {
    none,         // direction and magnitude are both free
    alternative,  // known or free, equally likely before: the evidence decides
    certain,
};

struct RefitOptions {
    int threads = 1;
    MagnitudeUse magnitude = MagnitudeUse::none;
    bool correct_for_mesh = true;  // take the mesh's error, as halved edges tell it, off the readings
    int steps = 12;                // Gauss-Newton's in each of two rounds, at most
    /// Whitened rms that another fit has left. A fit is abandoned if it would leave 1.5 times as much even with three
    /// times the predicted decrease, or if it has five times as much after six steps.
    double rival = INFINITY;
    NuisanceOptions nuisances;
};

}  // namespace palpate::identify
