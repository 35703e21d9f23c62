#pragma once

#include "identify/diagnosis/diagnose_options.h"
#include "identify/diagnosis/diagnosis.h"

namespace palpate::identify {

/// Does the evidence of an explanation allow a claim?
bool is_claimable(const FittedExplanation& explained, const DiagnoseOptions& options);

/// How many stiffness parameters a fit is free to choose.
Eigen::Index free_numbers(const Refit& fit);

/// Are the residuals of a fit noise, with no nuisance pulled beyond its prior?
bool leaves_only_noise(const Refit& fit, const DiagnoseOptions& options);

/// Least ln Bayes factor of an effect where the fit without it already leaves only noise: twice the usual one.
double least_next_to_noise(const DiagnoseOptions& options);

/// The same of an explanation as it was fitted: of an effect that resembles discretisation error also more than noise
/// and such an error together lend it, each with the probability of a false claim.
double least_next_to_noise(const FittedExplanation& explained, const Problem& problem, const DiagnoseOptions& options);

/// The same of what has no numbers in the fit, or on a body that cannot tell of its error: of what resembles
/// discretisation error more than the whole of such an error (a share of the displacement, or what halved edges leave)
/// can produce.
double least_next_to_noise(const EffectHypothesis& effect, const Problem& problem, const DiagnoseOptions& options);

/// Least ln Bayes factor of whatever is added to effects that already leave only noise: what they leave as
/// idealisations themselves is less.
double least_next_to_effect(const FittedExplanation& there, const DiagnoseOptions& options);

/// The same of what an explanation adds, as it was fitted, and of what has no numbers in the fit: errors of the mesh
/// and noise lend it less, too.
double least_next_to_effect(const FittedExplanation& explained, const FittedExplanation& there, const Problem& problem,
                            const DiagnoseOptions& options);
double least_next_to_effect(const EffectHypothesis& effect, const FittedExplanation& there, const Problem& problem,
                            const DiagnoseOptions& options);

/// Decides the verdict from the fitted explanations: one is claimed if its evidence is large enough and leads, if its
/// residuals are noise on fitted probes, hardly more on held-out ones and small against what it explains, and if no
/// nuisance is pulled beyond its prior. `diagnosis`: all but verdict, explanation, law, probabilities and next probe,
/// which are filled in; the ranking is put into order.
void decide_verdict(const BodyModel& model, const DiagnoseOptions& options, Diagnosis& diagnosis);

}  // namespace palpate::identify
