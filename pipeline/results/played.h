#pragma once

#include <vector>

#include "identify/fit/borne.h"
#include "identify/set/measurement_set.h"

namespace palpate::pipeline {

/// Plays every state of a set (one each, in their order), with what the body went through before where its material
/// remembers. A load that the model does not bear is lowered until it does. @throws SolverFailure where it never does.
std::vector<identify::Borne> play(const skeleton::Model& model, const identify::MeasurementSet& set);

}  // namespace palpate::pipeline
