#pragma once

#include <filesystem>

#include "identify/live/filter.h"

namespace palpate::pipeline {

/// What a filter knows, as a file: whole or not at all.
struct Cloud {
    int begun_with = 0;  // states of the set that it was calibrated with
    identify::FilterState state;
};

void write_cloud(const std::filesystem::path& file, const Cloud& cloud);
/// @throws IoError, InvalidInput naming the file and what to do.
Cloud read_cloud(const std::filesystem::path& file);

}  // namespace palpate::pipeline
