#pragma once

#include <string>
#include <utility>
#include <vector>

#include "pipeline/case/settings/overrides.h"
#include "pipeline/python/extension/conversions/border.h"

namespace palpate::python {

/// Settings of a case by their places, with values as YAML writes them.
using Overrides = std::vector<std::pair<std::string, std::string>>;

inline pipeline::CaseOverrides overrides_of(const Overrides& settings, const Call& call) {
    pipeline::CaseOverrides overrides;
    for (const auto& [place, value] : settings) overrides.set(place, value);
    overrides.seed = call.common.seed;
    return overrides;
}

}  // namespace palpate::python
