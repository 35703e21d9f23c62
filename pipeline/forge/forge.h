#pragma once

#include "pipeline/case/case.h"
#include "pipeline/forge/hide.h"

namespace palpate::pipeline {

/// A measurement set that was made up, and the truth about it.
struct Forged {
    identify::MeasurementSet set;
    std::vector<Hidden> hidden;  // effects that the set does not tell
    Strength strength;           // of all of them together
    double noise = 0;            // 1 sigma [mm]
    bool is_blind = false;       // something was asked to be hidden: neither material nor fields are told
    std::vector<Eigen::VectorXd> configurations;  // of each state: displacements of the nodes (3n), of finite elements
    std::vector<std::string> notes;               // what a user should know, in words
};

/// Probes a specimen: plans the loads, hides what is wished for, plays, and reads the markers with their faults.
///
/// Nothing of what is hidden changes the loads that the set tells. The same arguments give the same set, on any number
/// of threads. @throws InvalidInput for wishes that cannot be, SolverFailure where nothing finds an equilibrium.
Forged forge(const Specimen& specimen, const ProbeOptions& probing, const ForgeOptions& options, std::uint64_t seed,
             int threads, const Progress& progress = {});

}  // namespace palpate::pipeline
