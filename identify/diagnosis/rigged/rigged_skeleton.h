#pragma once

#include "identify/inference/identify_result.h"
#include "identify/inference/problem/identify_options.h"
#include "identify/measurements/measurement_set.h"
#include "mesh/progress.h"
#include "skeleton/statics/equilibrium.h"

namespace palpate::identify {

/// Does a state of the set move a tool or set an actuator, or is a reading the difference of two states?
bool is_rigged(const MeasurementSet& set);

/// A multiplier for each kind of a skeleton's stiffness, fitted to positions and reactions together under the law that
/// explains more; the model's own effects are fitted anew beside them. The posterior is Laplace's approximation, drawn
/// from by particles, 200 by default. Of `how` it takes particles, priors, seed and threads.
/// @throws InvalidInput, SolverFailure as diagnose.
IdentifyResult identify_rigged(const skeleton::Model& model, const MeasurementSet& set, const IdentifyOptions& how,
                               const Progress& progress = {});

/// How the model stands in each state of the set. @throws SolverFailure where one has no equilibrium.
std::vector<skeleton::Equilibrium> play_rigged(const skeleton::Model& model, const MeasurementSet& set, int threads);

/// What is read of each state at the model's equilibria.
struct RiggedPrediction {
    std::vector<Points> positions;  // of the state's readings (readings x 3) [mm]; NaN where one names no marker
    std::vector<Points> reactions;  // force, then moment of each of the state's reactions (2 reactions x 3) [N, N mm]
};
/// @throws SolverFailure where a state has no equilibrium.
RiggedPrediction predict_rigged(const skeleton::Model& model, const MeasurementSet& set, int threads);

}  // namespace palpate::identify
