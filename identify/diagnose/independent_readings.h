#pragma once

#include "identify/diagnose/problem.h"

namespace palpate::identify {

/// How many numbers the readings of a problem tell that do not follow from each other: for each way of loading (the
/// same places along the same lines, whatever size, sign and probe) and each coordinate of a marker, the terms of a
/// power series in the load that its displacement needs down to the noise. A body that answers in proportion gives one
/// of each, however many loads were put on; an explanation with as many numbers fits whatever was measured.
int independent_readings(const Problem& problem);

}  // namespace palpate::identify
