#pragma once

#include <cstdint>
#include <vector>

#include "identify/measurements/measurement_set.h"

namespace palpate::pipeline {

/// What is wrong with readings one by one.
struct ReadingFaults {
    double noise = 0;          // 1 sigma [mm]
    double outlier_share = 0;  // of the readings, that are off besides
    double outlier_width = 0;  // by so many sigmas (1 sigma of a normal distribution, in each coordinate)
    double missing = 0;        // share of the readings that are left out
    double unlabelled = 0;     // share of the others that do not tell their marker; they come last, in any order
};

/// The readings of a state out of true marker positions (m x 3). Each fault draws from a stream of its own: none
/// changes what another does, nor does another state. The same arguments give the same readings.
std::vector<identify::Reading> read_markers(const identify::LoadState& state, const Points& positions,
                                            const ReadingFaults& faults, std::uint64_t seed);

/// The same for a force that a tool's load cell reads, 1 sigma of `noise` [N] a component.
void add_reaction_noise(const identify::LoadState& state, double noise, std::uint64_t seed,
                        identify::ReactionReading& reading);

}  // namespace palpate::pipeline
