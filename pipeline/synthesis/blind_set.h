#pragma once

#include "pipeline/case/probe_options.h"
#include "pipeline/synthesis/effects/hidden_effect.h"

namespace palpate::pipeline {

/// A synthetic measurement set and its ground truth. Where no markers are read, strengths and noise are of the forces
/// of tools, in N.
struct BlindSet {
    identify::MeasurementSet set;
    std::vector<HiddenEffect> hidden;             // effects that the set does not disclose
    Strength strength;                            // of all of them together [mm or N]
    double noise = 0;                             // 1 sigma [mm or N]
    bool is_blind = false;                        // blind set: neither material nor fields are disclosed
    std::vector<Eigen::VectorXd> configurations;  // of each state: displacements of the nodes (3n), of finite elements
    std::vector<std::string> notes;               // what a user should know, in words
};

/// Synthesises a set: plans the loads, adds the hidden effects, solves, and reads the markers with measurement errors.
///
/// Nothing of what is hidden changes the loads that the set states. The same arguments give the same set, on any number
/// of threads. @throws InvalidInput for options that cannot be met, SolverFailure where nothing finds an equilibrium.
BlindSet synthesise(const Specimen& specimen, const ProbeOptions& probing, const BlindSetOptions& options,
                    std::uint64_t seed, int threads, const Progress& progress = {});

}  // namespace palpate::pipeline
