#include "pipeline/synthesis/options.h"

#include <fmt/format.h>

#include <algorithm>
#include <functional>

#include "mesh/errors.h"

namespace palpate::pipeline {

void RigOptions::validate() const {
    const auto belongs = [](bool one, const char* name, bool other, const char* needed) {
        if (one && !other) throw InvalidInput(fmt::format("{} is given without {}; give both", name, needed));
    };
    belongs(!tool.empty(), "--tool", !depth.empty(), "--depth");
    belongs(!depth.empty(), "--depth", !tool.empty(), "--tool");
    belongs(!cavity.empty(), "--cavity", !pressure.empty(), "--pressure");
    belongs(!tendon.empty(), "--tendon", !tension.empty() || !pull.empty(), "--tension or --pull");
    belongs(!tension.empty() || !pull.empty(), tension.empty() ? "--pull" : "--tension", !tendon.empty(), "--tendon");
    belongs(reaction_noise.has_value(), "--reaction-noise", !tool.empty(), "--tool");
    belongs(!markers, "--no-markers", !tool.empty(), "--tool");
    if (!tension.empty() && !pull.empty())
        throw InvalidInput("--tension and --pull are both given; a tendon is pulled by one of them");
    const auto rising = [](const std::vector<double>& values, const char* name, const char* unit) {
        for (const double value : values) {
            if (!(value > 0))
                throw InvalidInput(fmt::format("{} is {}, allowed is a value above 0 {}", name, value, unit));
        }
        if (std::ranges::adjacent_find(values, std::greater_equal<>()) != values.end())
            throw InvalidInput(fmt::format("{} is {}, allowed are values that rise", name, fmt::join(values, ", ")));
    };
    rising(depth, "--depth", "mm");
    rising(pressure, "--pressure", "MPa");
    rising(tension, "--tension", "N");
    rising(pull, "--pull", "mm");
    if (reaction_noise && !(*reaction_noise >= 0))
        throw InvalidInput(fmt::format("--reaction-noise is {}, allowed is 0 N or more", *reaction_noise));
}

void BlindSetOptions::validate() const {
    rig.validate();
    const auto require = [](bool holds, const char* what, double value, const char* allowed) {
        if (!holds) throw InvalidInput(fmt::format("{} is {}, allowed is {}", what, value, allowed));
    };
    require(levels >= 0 && levels <= 100, "levels", levels, "0 to 100");
    for (const double time : dwell) require(time > 0, "dwell", time, "a time above 0 s");
    if (std::ranges::adjacent_find(dwell, std::greater_equal<>()) != dwell.end()) {
        throw InvalidInput(fmt::format("dwell is {} s, allowed are times that rise", fmt::join(dwell, ", ")));
    }
    if (noise) require(*noise >= 0, "noise", *noise, "0 mm or more");
    require(missing >= 0 && missing <= 0.9, "missing", missing, "a share from 0 to 0.9");
    require(unlabelled >= 0 && unlabelled <= 1, "unlabelled", unlabelled, "a share from 0 to 1");
}

}  // namespace palpate::pipeline
