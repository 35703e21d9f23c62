#pragma once

#include <filesystem>
#include <string>

#include "pipeline/case/case.h"

namespace palpate::pipeline {

class CaseOverrides;

/// A case from a case.yaml, a measurement set (folder or set.yaml) or a bare mesh, told apart by what they are.
/// @throws IoError, InvalidInput.
Case read_case(const std::filesystem::path& input, const CaseOverrides& overrides);
Case read_case(const std::filesystem::path& input);

/// The case with every setting, defaults included, as YAML that read_case reads back.
std::string to_yaml(const Case& settings);

}  // namespace palpate::pipeline
