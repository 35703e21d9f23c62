#pragma once

#include <string>
#include <vector>

#include "identify/measurements/measurement_set.h"

namespace palpate::identify {

/// The contacts of states as probes.csv, in mm, N, s: `read_probes` reads it back.
std::string probes_table(const std::vector<LoadState>& states);

}  // namespace palpate::identify
