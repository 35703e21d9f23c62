#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <string_view>

#include "pipeline/case/settings/overrides.h"

// Flags that several commands share.

namespace palpate::pipeline {

/// The flag of a setting of the case, by its place in case.yaml.
void add_flag(CLI::App* command, CaseOverrides& overrides, std::string_view place);

/// The flags of all settings of a group: "Body", "Skeleton", "Sphere curve", "Probing", "Identification", "Diagnosis".
void add_flags_of(CLI::App* command, CaseOverrides& overrides, std::string_view group);

/// `when`: the reference body is the default.
void add_body(CLI::App* command, std::string& body, const std::string& when);

}  // namespace palpate::pipeline
