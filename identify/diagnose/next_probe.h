#pragma once

#include "identify/diagnose/diagnose.h"

namespace palpate::identify {

/// The probe that would separate two explanations that the measurements leave alike. Where the effects themselves say
/// how (turn the body, repeat), that; else the load, of those tried over the body, under which the two fits differ
/// most.
NextProbe separate(const BodyModel& model, const Problem& problem, const Explained& a, const Explained& b, int threads);

}  // namespace palpate::identify
