#pragma once

#include "identify/diagnosis/fit/refit.h"

namespace palpate::identify {

/// How well a fit predicts what it has not seen: each probe's readings from all others, by the fit's own linearisation.
struct HeldOut {
    double rms_mm = 0;              // over all measured coordinates; the contacts' nuisances are unknown there
    double rms_n = missing;         // over all measured forces of tools; NaN where there are none
    double whitened_rms = 0;        // in sigmas of noise and nuisances
    Eigen::VectorXd residual = {};  // residual of the predictions after marginalising the unknowns, in sigmas (N)
};
HeldOut leave_probes_out(const Problem& problem, const Refit& fit);

/// What is left out together, for each row (N): a probe's readings; where all loads are one probe's, a load's.
std::vector<int> held_out_groups(const Problem& problem);

/// A fit's explanation in another problem of the same body.
struct HeldOutPrediction {
    Explanation explanation;     // parameters specific to the new probes keep their priors; effects that cannot be
                                 // observed there are left out
    Eigen::MatrixXd covariance;  // of its numbers
    Problem problem;  // stage by stage where it has a memory; loads that the body does not bear as far as it does
    ForwardSolution forward;
};
/// @throws SolverFailure where an action has no equilibrium under a tenth of its load either.
HeldOutPrediction predict_response(const BodyModel& model, const Problem& unseen, const Refit& fit,
                                   const RefitOptions& options);

/// Predictive accuracy of a fit on another problem of the same body, from its own equilibria there; the posterior of
/// the fit and the nuisances of the new probes are marginalised. A load without equilibrium is reduced until there is
/// one.
/// @throws SolverFailure where an action has no equilibrium under a tenth of its load either.
HeldOut predict(const BodyModel& model, const Problem& unseen, const Refit& fit, const RefitOptions& options);

}  // namespace palpate::identify
