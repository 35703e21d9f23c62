#pragma once

#include "identify/diagnose/diagnose.h"

namespace palpate::identify {

/// Does the evidence of an explanation allow a claim?
bool is_likely(const Explained& explained, const DiagnoseOptions& options);

/// Is what a fit leaves noise, with no nuisance strained?
bool is_enough(const Refit& fit, const DiagnoseOptions& options);

/// ln Bayes factor that an effect has to bring where what is left without it is noise already: twice as much as
/// elsewhere, and one that is like an error of the mesh more than such errors may feign, which are a share of the
/// displacement.
double least_next_to_noise(const Effect& effect, const Problem& problem, const DiagnoseOptions& options);

/// The same next to effects that are there and leave noise: more than their own idealisation may feign, too.
double least_next_to_effect(const Effect& effect, const Explained& there, const Problem& problem,
                            const DiagnoseOptions& options);

/// Comes to a verdict on what was tried: an explanation is claimed if its evidence is great enough and leads, what is
/// left is noise on fitted probes, hardly more on held-out ones and little next to what it explains, and no nuisance is
/// strained.
/// `diagnosis`: all but verdict, explanation, law, probabilities and next probe, which are filled in; the ranking is
/// put into order.
void judge(const BodyModel& model, const DiagnoseOptions& options, Diagnosis& diagnosis);

}  // namespace palpate::identify
