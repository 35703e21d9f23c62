#pragma once

#include <string_view>

namespace palpate::pipeline {

// Files of this folder.
extern const std::string_view batch_snakefile_text, slurm_status_text;

}  // namespace palpate::pipeline
