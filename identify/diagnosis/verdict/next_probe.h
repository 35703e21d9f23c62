#pragma once

#include "identify/diagnosis/diagnosis.h"

namespace palpate::identify {

/// The probe that would separate explanations that the measurements leave alike (two or more): of those that a rig like
/// the set's could make, the one under which the two that it tells apart least are furthest apart, in sigmas of noise,
/// of the probe's nuisances, and of what the fits leave open. Where none can be played, what the
/// first one's effects ask for by themselves.
NextProbe separate(const BodyModel& model, const Problem& problem, const std::vector<const FittedExplanation*>& alike,
                   const RefitOptions& options);

}  // namespace palpate::identify
