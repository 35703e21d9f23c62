#pragma once

#include "identify/diagnosis/diagnose_options.h"
#include "identify/diagnosis/diagnosis.h"
#include "mesh/progress.h"

namespace palpate::identify {

/// Screens the catalogue with a score test, refits the leading candidates under the relevant material laws, and returns
/// a verdict: adequate, missing effect, ambiguous or unexplained. [design: score test, Laplace evidence, leave-one-out]
/// @throws SolverFailure when the model has no equilibria under these loads; InvalidInput without labelled readings.
Diagnosis diagnose(const BodyModel& model, const MeasurementSet& set, const DiagnoseOptions& options,
                   const Progress& progress = {});

}  // namespace palpate::identify
