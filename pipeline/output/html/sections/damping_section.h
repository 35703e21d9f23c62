#pragma once

#include <filesystem>
#include <string>

namespace palpate::pipeline {

/// How motion dies away: measured next to played, and the modes with their ratios, of an identification's folder; ""
/// where nothing was recorded.
std::string damping_section(const std::filesystem::path& folder);

}  // namespace palpate::pipeline
