#pragma once

#include <optional>

#include "identify/diagnosis/diagnosis.h"

namespace palpate::identify {

/// What an explanation, or the baseline where there is none, leaves of the readings, as an effect that models show:
/// where a fit may begin with it. Its numbers are of first order about the model without it.
struct Residual {
    skeleton::EffectRecord effect;
    double log_bayes_factor = 0;  // of all such sources, against nothing
};

/// Absent: nothing is left that a source explains which acts alike in all states, or holds the body by springs. Those
/// that go with a load or with the time have no cause that a model knows of; faults of the readings are none of a body.
std::optional<Residual> find_residual(const BodyModel& model, const Diagnosis& diagnosis, int threads);

}  // namespace palpate::identify
