#pragma once

#include "identify/measurements/measurement_set.h"

namespace palpate::identify {

/// A table of markers alone (markers.csv, in mm). @throws IoError, InvalidInput.
std::vector<Marker> read_markers(const std::filesystem::path& file);

}  // namespace palpate::identify
