#pragma once

#include "identify/diagnosis/diagnosis.h"

namespace palpate::identify {

/// A probe that could be made next.
struct CandidateProbe {
    NextProbe probe;                // what it is, without what it would tell
    std::string asks;               // what is to be done, as a clause
    std::vector<LoadState> states;  // what would be read, without readings; none: only what stands still
    ProbeConditions conditions = {};
};

/// Probes that a rig can make which made the set's own: pushes and pulls over the markers, own probes once more, held
/// longer, or stronger and taken off again; the unloaded body turned, and vented where it has cavities; points read
/// that stand still.
std::vector<CandidateProbe> candidate_probes(const BodyModel& model, const Problem& problem);

}  // namespace palpate::identify
