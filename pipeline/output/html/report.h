#pragma once

#include <filesystem>

namespace palpate::pipeline {

/// Writes a run as one self-contained page that needs no network: what was fitted, how wrong it is and where, the
/// identified stiffnesses against their priors, settings, versions, times.
/// @throws IoError when the folder lacks a file that the page shows.
void write_report(const std::filesystem::path& run, const std::filesystem::path& page);

}  // namespace palpate::pipeline
