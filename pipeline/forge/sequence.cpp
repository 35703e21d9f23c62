#include "pipeline/forge/sequence.h"

namespace palpate::pipeline {

Sequence sequence_of(const ForgeOptions& options, const std::vector<Wish>& wishes) {
    const bool yields = is_among("plasticity", wishes), creeps = is_among("viscosity", wishes);
    Sequence sequence{{options.unload.value_or(yields), options.dwell}, options.continuous.value_or(yields), {}};
    if (yields && !(options.unload && options.continuous)) {
        sequence.notes.emplace_back(
            "Plasticity shows in what stays: one body goes through all probes, let go after each (--no-unload, "
            "--no-continuous say otherwise).");
    }
    if (creeps && options.dwell.empty()) {
        sequence.rhythm.dwell = {0.1, 4, 20};
        sequence.notes.emplace_back(
            "Viscosity shows in time: each load is read 0.1, 4 and 20 s after it was put on (--dwell says otherwise).");
    }
    return sequence;
}

}  // namespace palpate::pipeline
