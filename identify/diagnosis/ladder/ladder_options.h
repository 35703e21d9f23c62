#pragma once

#include <optional>
#include <vector>

#include "identify/diagnosis/diagnose_options.h"
#include "identify/diagnosis/locate/residual.h"
#include "identify/inference/problem/identify_options.h"

namespace palpate::identify {

struct LadderOptions {
    IdentifyOptions identify;
    DiagnoseOptions diagnose;
    /// An effect that makes held-out probes worse (a fault of the measurement: in normalised errors), or leaves a state
    /// without equilibrium, is not added. Those that a diagnosis names are then tried together, too.
    bool only_better = false;
    /// One of the effects that was located in what is left and has to make held-out probes better.
    std::optional<Residual> residual = {};
    std::vector<skeleton::EffectRecord> start = {};  // numbers of effects to begin with, where no diagnosis has any
};

}  // namespace palpate::identify
