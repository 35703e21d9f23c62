#pragma once

#include <filesystem>
#include <vector>

#include "pipeline/command_line/commands.h"

namespace palpate::pipeline::commands {

struct ImportCommandOptions {
    std::vector<std::filesystem::path> files;  // of the rig, or folders of them
    std::filesystem::path output;              // a set; with `describe` a map
    std::filesystem::path map = {};            // empty: map.yaml beside the first file
    bool describe = false;                     // what is in the files, and a map to edit
    std::filesystem::path mesh = {};           // in place of the map's
    std::string states = {}, registration = {}, unit = {};
};
/// A measurement set out of what a rig wrote. @throws InvalidInput, IoError.
Outcome import(const ImportCommandOptions& options, const Common& common);

}  // namespace palpate::pipeline::commands
