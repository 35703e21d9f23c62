#pragma once

#include "identify/diagnose/refit.h"

namespace palpate::identify {

/// How well a fit predicts what it has not seen: each probe's readings from all others, by the fit's own linearisation.
struct HeldOut {
    double rms_mm = 0;              // over all measured coordinates; the contacts' nuisances are unknown there
    double whitened_rms = 0;        // in sigmas of noise and of what nobody can know
    Eigen::VectorXd residual = {};  // predictions only: what the unknowns do not explain either, in sigmas (N)
};
HeldOut leave_probes_out(const Problem& problem, const Refit& fit);

/// What is left out together, for each row (N): a probe's readings; where all loads are one probe's, a load's.
std::vector<int> held_out_groups(const Problem& problem);

/// A fit's explanation in another problem of the same body.
struct Foretold {
    Explanation explanation;     // numbers that go with the new probes are as likely as any; effects that cannot show
                                 // there are left out
    Eigen::MatrixXd covariance;  // of its numbers
    Problem problem;  // stage by stage where it has a memory; loads that the body does not bear as far as it does
    Played played;
};
/// @throws SolverFailure where an action has no equilibrium under a tenth of its load either.
Foretold foretell(const BodyModel& model, const Problem& unseen, const Refit& fit, const RefitOptions& options);

/// How well a fit predicts another problem of the same body, by its own equilibria there: what the fit left uncertain
/// and the nuisances of the new probes count as unknown. A load that the body does not bear is played as far as it
/// does.
/// @throws SolverFailure where an action has no equilibrium under a tenth of its load either.
HeldOut predict(const BodyModel& model, const Problem& unseen, const Refit& fit, const RefitOptions& options);

}  // namespace palpate::identify
