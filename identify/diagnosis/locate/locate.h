#pragma once

#include <functional>
#include <optional>

#include "identify/diagnosis/fit/refit_result.h"
#include "identify/diagnosis/locate/missing_source.h"

namespace palpate::identify {

/// What a fit leaves of the readings, located, by a linear model at its configurations. Sources of four kinds, in many
/// places of several sizes and under several laws, compete by evidence; those of the likeliest kind are averaged.
/// Absent: nothing is left that any source would explain. `is_candidate`: which may; absent: all.
std::optional<MissingSource> locate_missing(const BodyModel& model, const Problem& problem, const Refit& fit,
                                            int threads,
                                            const std::function<bool(const SourceTerm&)>& is_candidate = {});

}  // namespace palpate::identify
