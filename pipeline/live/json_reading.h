#pragma once

#include <string>

#include "identify/measurements/measurement_set.h"

namespace palpate::pipeline {

/// A reading from a line of JSON, in mm, N and s:
///   {"probe": 3, "time": 0, "contacts": [{"at": [x, y, z], "force": [fx, fy, fz], "radius": r}],
///    "markers": {"12": [x, y, z], ...}}
/// null is a coordinate that was not read. `where`: begins messages. @throws InvalidInput.
identify::LoadState read_json_reading(const std::string& line, const identify::MeasurementSet& set,
                                      const std::string& where);

}  // namespace palpate::pipeline
