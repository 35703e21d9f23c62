#include "pipeline/synthesis/loading/load_sequence.h"

#include <fmt/format.h>

#include "mesh/text/words.h"

namespace palpate::pipeline {

Sequence sequence_of(const BlindSetOptions& options, const std::vector<EffectSpec>& specs) {
    const EffectSpec* stays = first_with(&identify::SynthesisNeeds::release, specs);
    const EffectSpec* creeps = first_with(&identify::SynthesisNeeds::dwells, specs);
    const EffectSpec* changes = first_with(&identify::SynthesisNeeds::changing_loads, specs);
    const EffectSpec* returns = first_with(&identify::SynthesisNeeds::reloads, specs);
    const bool released = stays != nullptr, back = options.back.value_or(returns != nullptr);
    Sequence sequence{
        {.unload = options.unload.value_or(released || changes != nullptr), .back = back, .dwell = options.dwell},
        options.levels,
        options.continuous.value_or(released || returns),
        {}};
    if (back && sequence.levels == 0) sequence.levels = 2;
    if (returns && !(options.back && options.continuous)) {
        sequence.notes.push_back(
            fmt::format("{} shows where less is borne after more: one body goes through all probes, each to half and "
                        "all of its load, back to half, and let go (--levels, --no-back, --no-continuous "
                        "change this).",
                        mesh::capitalised(returns->effect)));
    }
    if (stays && !(options.unload && options.continuous)) {
        sequence.notes.push_back(
            fmt::format("{} shows in what stays: one body goes through all probes, let go after each (--no-unload, "
                        "--no-continuous change this).",
                        mesh::capitalised(stays->effect)));
    }
    if (changes && sequence.levels == 0) {
        sequence.levels = 3;
        sequence.notes.push_back(
            fmt::format("{} shows where loads change: each probe presses at three levels, let go after each (--levels "
                        "and --no-unload change this).",
                        mesh::capitalised(changes->effect)));
    }
    if (creeps && options.dwell.empty()) {
        sequence.timing.dwell = {0.1, 4, 20};
        sequence.notes.push_back(
            fmt::format("{} shows in time: each load is read 0.1, 4 and 20 s after it was put on (--dwell says "
                        "otherwise).",
                        mesh::capitalised(creeps->effect)));
    }
    return sequence;
}

}  // namespace palpate::pipeline
