#pragma once

#include "identify/diagnosis/fit/explanation.h"

namespace palpate::identify {

/// How an effect is screened at a fit that lacks it: as it says itself, or else by its numbers. Keeps references to the
/// arguments.
ScreenPlan screen_plan(const EffectHypothesis& effect, const BodyModel& model, const Problem& problem,
                       const Explanation& explanation, const ForwardSolution& forward);

/// By the signatures of all its numbers at their start, which must be neutral; a refit begins there.
ScreenPlan screen_plan_by_numbers(const EffectHypothesis& effect, const BodyModel& model, const Problem& problem,
                                  const Explanation& explanation, const ForwardSolution& forward);

}  // namespace palpate::identify
