#pragma once

#include "identify/diagnosis/problem.h"

namespace palpate::identify {

/// Number of independent data in a problem: for each load direction (same places and lines of action, whatever
/// magnitude, sign and probe) and each marker coordinate, the number of terms of a power series in the load that its
/// displacement supports above the noise. A linear response gives one per pair, however many load levels were applied;
/// an explanation with as many parameters fits any data.
int independent_readings(const Problem& problem);

}  // namespace palpate::identify
