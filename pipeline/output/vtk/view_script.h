#pragma once

#include <filesystem>

namespace palpate::pipeline {

/// Writes view.py: a ParaView script that opens a run from the folder that the script lies in.
void write_view_script(const std::filesystem::path& script);

}  // namespace palpate::pipeline
