#pragma once

#include <filesystem>
#include <string>

#include "identify/diagnosis/diagnosis.h"

namespace palpate::pipeline {

/// What is missing, located, as a series missing.pvd in a folder, time = index of the state: the rest surface with its
/// density there and the standard deviation of it; of sensors' errors, the markers with how far their readings are off.
/// @returns the file's name; empty where nothing was located.
std::string write_missing_series(const std::filesystem::path& folder, const identify::MeasurementSet& set,
                                 const identify::Diagnosis& diagnosis);

}  // namespace palpate::pipeline
