#pragma once

#include "identify/diagnose/diagnose.h"

namespace palpate::identify {

/// Does the evidence of an explanation allow a claim?
bool is_likely(const Explained& explained, const DiagnoseOptions& options);

/// Is what a fit leaves noise, with no nuisance strained?
bool is_enough(const Refit& fit, const DiagnoseOptions& options);

/// Comes to a verdict on what was tried: an explanation is claimed if its evidence is great enough and leads, what is
/// left is noise on fitted and on held-out probes, and no nuisance is strained. `diagnosis`: all but verdict,
/// explanation, law, probabilities and next probe, which are filled in; the ranking is put into order.
void judge(const BodyModel& model, const DiagnoseOptions& options, Diagnosis& diagnosis);

}  // namespace palpate::identify
