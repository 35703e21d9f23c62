#pragma once

#include <functional>
#include <optional>

#include "identify/diagnosis/diagnose_options.h"
#include "identify/diagnosis/diagnosis.h"
#include "identify/diagnosis/locate/missing_source.h"

namespace palpate::identify {

/// What a fit leaves of the readings, located, by a linear model at its configurations. Sources of four kinds, in many
/// places of several sizes and under several laws, compete by evidence; those of the likeliest kind are averaged.
/// Absent: nothing is left that any source would explain. `is_candidate`: which may; absent: all.
std::optional<MissingSource> locate_missing(const BodyModel& model, const Problem& problem, const Refit& fit,
                                            int threads,
                                            const std::function<bool(const SourceTerm&)>& is_candidate = {});

/// The same of a diagnosis, from what its baseline leaves; where single readings are all that is wrong, those. Where no
/// effect explains the readings, the source is fitted.
std::optional<MissingSource> where_missing(const BodyModel& model, const MeasurementSet& set,
                                           const Diagnosis& diagnosis, const DiagnoseOptions& options);

}  // namespace palpate::identify
