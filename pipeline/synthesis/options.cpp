#include "pipeline/synthesis/options.h"

#include <fmt/format.h>

#include <algorithm>
#include <functional>

#include "mesh/errors.h"

namespace palpate::pipeline {

void BlindSetOptions::validate() const {
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
