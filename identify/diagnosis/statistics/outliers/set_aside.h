#pragma once

#include <optional>
#include <vector>

#include "identify/diagnosis/statistics/outliers/outliers.h"

namespace palpate::identify {

/// Outliers that may be set aside, numbered as the set does, and the rows of the problem that stay.
struct SetAside {
    Outliers outliers;
    std::vector<char> others;  // (N)
};

/// Readings that are off by themselves, as a fit sees them whose numbers may still move. None where they bring less
/// than `least` of evidence, or where much is left without them.
std::optional<SetAside> single_readings_off(const Problem& problem, const Refit& fit, double least);

}  // namespace palpate::identify
