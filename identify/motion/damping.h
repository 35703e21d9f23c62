#pragma once

#include <cstdint>
#include <optional>

#include "identify/measurements/measurement_set.h"
#include "identify/motion/damping_result.h"
#include "mesh/progress.h"
#include "skeleton/model/model.h"

namespace palpate::identify {

struct DampingOptions {
    int modes = 24;  // slowest ones that are looked at
    int most = 8;    // of them fitted
    int particles = 400;
    std::uint64_t seed = 1;
    int threads = 1;
};

/// Finds how a model's motion dies away from a set's recordings, and puts it into the model; nothing where the set has
/// none. Where the set tells no density and nothing weighs, masses are scaled so that the model vibrates as fast as
/// the body.
///
/// The markers ring in the model's modes about its equilibrium, q_i'' + 2 z_i w_i q_i' + w_i^2 q_i = 0 off the
/// equilibria between which loads change, so that every prediction is exact in time. Unknown are the ratio of the
/// slowest mode, how it goes with frequency (`law`, chosen by evidence), how much faster the body vibrates than the
/// model, when loads truly changed; and of each mode how far its own ratio, frequency and amplitude are off all that.
/// Errors of the model are alike from one instant to the next and from marker to marker: readings are weighed as so
/// many as are independent by the correlation of what the best fit leaves.
/// @throws InvalidInput when a sphere has no mass, or no mode moves the markers; SolverFailure as equilibrium.
std::optional<DampingResult> identify_damping(skeleton::Model& model, const MeasurementSet& set,
                                              const DampingOptions& options = {}, const Progress& progress = {});

}  // namespace palpate::identify
