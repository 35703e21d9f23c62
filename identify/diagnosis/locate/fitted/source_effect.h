#pragma once

#include "identify/diagnosis/fit/refit_result.h"
#include "identify/diagnosis/locate/missing_source.h"

namespace palpate::identify {

/// The effect that a source is; "": models have none for it.
const char* effect_of(const SourceTerm& term);

/// A source as an effect of a model, where a fit may begin with it. `size`: of the body [mm]. @pre models have one
skeleton::EffectRecord record_of(const SourceTerm& term, double size);

/// A source as a fit has it whose last effect it is: its place, and its numbers in the form in which it was `located`.
SourceTerm term_of(const SourceTerm& located, const Refit& fit);

}  // namespace palpate::identify
