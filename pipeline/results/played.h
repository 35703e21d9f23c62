#pragma once

#include <vector>

#include "identify/set/measurement_set.h"
#include "skeleton/equilibrium.h"

namespace palpate::pipeline {

/// A state of a set as a model answers it.
struct Played {
    skeleton::Equilibrium equilibrium;
    skeleton::Load load;  // what acts; less than the set tells where the model does not bear it all
};

/// Plays every state of a set (one each, in their order), with what the body went through before where its material
/// remembers. A load that the model does not bear is lowered until it does. @throws SolverFailure where it never does.
std::vector<Played> play(const skeleton::Model& model, const identify::MeasurementSet& set);

}  // namespace palpate::pipeline
