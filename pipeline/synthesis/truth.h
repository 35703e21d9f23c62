#pragma once

#include <nlohmann/json.hpp>

#include "pipeline/synthesis/blind_set.h"

namespace palpate::pipeline {

/// All that a synthetic set does not state, as truth.json: law, material, noise, seed, each hidden effect with its
/// numbers, units and how much it changes the readings (in N where no markers are read), and `hide`: what to give
/// `palpate probe` to hide the same again.
nlohmann::json truth_of(const BlindSet& blind_set, const Specimen& specimen, const BlindSetOptions& options,
                        std::uint64_t seed);

}  // namespace palpate::pipeline
