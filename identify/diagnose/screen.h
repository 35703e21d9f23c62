#pragma once

#include <optional>

#include "identify/diagnose/fit.h"
#include "identify/diagnose/refit.h"

namespace palpate::identify {

/// What the score test says of an effect at a fit that lacks it.
struct Screened {
    std::shared_ptr<const Effect> effect;
    double log_bayes_factor = 0;                    // averaged over the alternatives: places, directions
    double keep = 0;                                // b^T V^-1 b / b^T W^2 b
    double predicted_rms_mm = 0;                    // of the errors once it is in, by this linearisation
    std::vector<Eigen::VectorXd> starts = {};       // values to begin a refit with; each after the first has less of it
    std::optional<Eigen::VectorXd> elsewhere = {};  // the same in another place that promises nearly as much

    /// The most that a refit may bring: this is a linearisation, which it may exceed twice over, and of little several
    /// times.
    double at_most() const { return 2 * log_bayes_factor + 200; }
};

/// Screens effects without refitting, by their force signatures at the fit; in the order given, those left out that
/// cannot show in the problem. One factorisation an action serves all.
std::vector<Screened> screen_effects(const BodyModel& model, const Problem& problem, const Refit& fit,
                                     const std::vector<std::shared_ptr<const Effect>>& effects, int threads);

/// A fit as a start for explanations with a memory: in the problem stage by stage.
Refit spread_over_stages(const BodyModel& model, const Refit& fit, const Problem& merged, const Problem& stages);

}  // namespace palpate::identify
