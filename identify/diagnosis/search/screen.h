#pragma once

#include <functional>
#include <optional>

#include "identify/diagnosis/fit/explanation.h"
#include "identify/diagnosis/fit/refit.h"

namespace palpate::identify {

/// What the score test says of an effect at a fit that lacks it.
struct ScreenedEffect {
    std::shared_ptr<const EffectHypothesis> effect;
    double log_bayes_factor = 0;                    // averaged over the alternatives: places, directions
    double identifiable = 0;                        // b^T V^-1 b / b^T W^2 b
    double predicted_rms_mm = 0;                    // of the errors once it is in, by this linearisation
    std::vector<Eigen::VectorXd> starts = {};       // values to begin a refit with; each after the first has less of it
    std::optional<Eigen::VectorXd> elsewhere = {};  // the same in another place that promises nearly as much
    std::vector<Eigen::VectorXd> scan = {};         // see ScreenPlan

    /// Upper bound for a refit: the screen is a linearisation, which a refit may exceed twofold, and a small one
    /// several times. Design choice: a higher bound costs refits that do not lead, a lower one may miss one that does.
    double at_most() const { return 2 * log_bayes_factor + 200; }
};

/// Screens effects without refitting, by their force signatures at the fit; in the order given, those left out that
/// cannot show in the problem. One factorisation an action serves all.
std::vector<ScreenedEffect> screen_effects(const BodyModel& model, const Problem& problem, const Refit& fit,
                                           const std::vector<std::shared_ptr<const EffectHypothesis>>& effects,
                                           int threads);

/// Where a refit with an effect begins, by the refit's objective there: at the best of its scan, else with as much of
/// it as leaves the objective below `without`.
Eigen::VectorXd start_of(const ScreenedEffect& screened, double without,
                         const std::function<double(const Eigen::VectorXd& start)>& objective);

/// A fit as a start for explanations with a memory: in the problem stage by stage.
Refit expand_to_stages(const BodyModel& model, const Refit& fit, const Problem& merged, const Problem& stages);

}  // namespace palpate::identify
