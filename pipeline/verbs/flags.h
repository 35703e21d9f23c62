#pragma once

#include <CLI/CLI.hpp>

#include "pipeline/case/case.h"

namespace palpate::pipeline {

// Flags that several verbs share, each group for one part of a case.

void add_body_flags(CLI::App* verb, CaseOverrides& say);
void add_skeleton_flags(CLI::App* verb, CaseOverrides& say);
void add_probing_flags(CLI::App* verb, CaseOverrides& say);
void add_identify_flags(CLI::App* verb, CaseOverrides& say);
/// Size of the elements of a reference body.
void add_edge_length(CLI::App* verb, CaseOverrides& say);

/// `when`: the reference is it, "by default".
void add_body(CLI::App* verb, std::string& body, const std::string& when);

}  // namespace palpate::pipeline
