#pragma once

#include <string>

#include "pipeline/output/html/run_files.h"

namespace palpate::pipeline {

/// Where the model is wrong: in words, on the body, by state and over the load; with what was added, where something
/// was.
std::string error_section(const RunFiles& files);

}  // namespace palpate::pipeline
