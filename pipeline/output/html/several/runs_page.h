#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>

namespace palpate::pipeline {

/// Runs side by side as one self-contained page. `runs`: as runs_json makes it.
void write_runs_page(const std::filesystem::path& page, const nlohmann::json& runs);

}  // namespace palpate::pipeline
