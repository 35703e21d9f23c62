#pragma once

#include <CLI/CLI.hpp>

#include "pipeline/command_line/command_tree.h"

namespace palpate::pipeline {

/// What CLI11 was told, as data.
CommandTree tree_of(const CLI::App& app);

}  // namespace palpate::pipeline
