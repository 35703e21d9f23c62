#pragma once

#include <string>
#include <vector>

#include "pipeline/synthesis/effects/effect_spec.h"
#include "pipeline/synthesis/loading/probe_load_history.h"

namespace palpate::pipeline {

/// What a body goes through from load to load: as asked for, and as those effects need it that show in time only.
struct Sequence {
    LoadTiming timing;
    int levels = 0;                  // as in BlindSetOptions
    bool continuous = false;         // one body goes through all probes
    std::vector<std::string> notes;  // what was chosen without being asked for, in words
};

/// What shows where less is borne after more, as damage does, has one body go through all probes, each up to two levels
/// and back, then let go. What shows in what stays, as plasticity does, has one body go through all probes, let go
/// after each; what shows in time, as viscosity, is read 0.1, 4 and 20 s after a load was put on; what shows where
/// loads change, as an error of clocks, has each probe press at three levels, let go after each; unless told otherwise.
Sequence sequence_of(const BlindSetOptions& options, const std::vector<EffectSpec>& specs);

}  // namespace palpate::pipeline
