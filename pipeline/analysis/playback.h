#pragma once

#include <vector>

#include "identify/loading/reduced_load.h"
#include "identify/measurements/measurement_set.h"

namespace palpate::pipeline {

/// Plays every state of a set (one each, in their order), with what the body went through before where its material
/// remembers. A load that the model does not bear is lowered until it does. @throws SolverFailure where it never does.
std::vector<identify::ReducedLoadEquilibrium> play(const skeleton::Model& model, const identify::MeasurementSet& set);

/// How far the skin's points are from where they are at rest (vertices x 3) [mm].
Points skin_displacement(const skeleton::Model& model, const skeleton::Equilibrium& equilibrium,
                         const skeleton::Load& load);

}  // namespace palpate::pipeline
