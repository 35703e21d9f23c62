#pragma once

#include <vector>

#include "identify/diagnosis/fit/priors/fit_priors.h"
#include "identify/diagnosis/fit/refit_result.h"

namespace palpate::identify {

/// Half of chi^2 and priors, to be lowered.
double objective(const Whitening& V, const Eigen::VectorXd& d, const FitPriors& priors, const Eigen::VectorXd& x);

/// What a solution leaves of the readings, over sigma (N).
Eigen::VectorXd error_of(const Problem& problem, const ForwardSolution& forward);

/// A fit in progress by Gauss-Newton steps, at fixed V. Keeps references to the arguments.
class Descent {
public:
    Descent(const BodyModel& model, const Problem& problem, const FitPriors& priors, const RefitOptions& options,
            Refit& at);

    /// `to_the_end`: else it may stop where it hardly gets on, as V is not the last one, and bodies with memory are
    /// slow to play.
    void run(int most_steps, bool to_the_end);

    /// To be told when the states have been replaced between two runs: slopes are taken anew.
    void states_replaced() { has_slopes_ = false; }

private:
    bool cannot_catch_up(double now, double promised) const;
    bool advance(const Eigen::VectorXd& move, double& now);
    void linearise();

    const BodyModel& model_;
    const Problem& problem_;
    const FitPriors& priors_;
    int threads_;
    double rival_;  // whitened rms, at least that of noise
    Refit& at_;
    bool has_slopes_ = false;             // columns and steps are those of where it stands
    bool is_shortened_ = false;           // the last step went less far than it was meant to
    std::vector<Eigen::MatrixXd> steps_;  // J^-1 times the signatures, of each action
};

}  // namespace palpate::identify
