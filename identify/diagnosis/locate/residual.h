#pragma once

#include <optional>

#include "identify/diagnosis/diagnose_options.h"
#include "identify/diagnosis/diagnosis.h"
#include "identify/diagnosis/locate/fitted/source_fit.h"

namespace palpate::identify {

/// What the baseline of a diagnosis leaves, located; where single readings are all that is wrong, those. Where no
/// effect explains the readings, the source is fitted.
std::optional<MissingSource> where_missing(const BodyModel& model, const MeasurementSet& set,
                                           const Diagnosis& diagnosis, const DiagnoseOptions& options);

/// What an explanation, or the baseline where there is none, leaves of the readings, as an effect that models show:
/// where a fit may begin with it.
struct Residual {
    skeleton::EffectRecord effect;
    double log_bayes_factor = 0;    // of all such sources, against nothing
    std::optional<Refit> fit = {};  // of it, where it was fitted
};

/// Absent: nothing is left that a source explains which acts alike in all states, or holds the body by springs. Those
/// that go with a load or with the time have no cause that a model knows of; faults of the readings are none of a body.
std::optional<Residual> find_residual(const BodyModel& model, const Diagnosis& diagnosis,
                                      const DiagnoseOptions& options);

}  // namespace palpate::identify
