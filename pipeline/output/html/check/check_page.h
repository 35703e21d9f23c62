#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string_view>

#include "pipeline/case/subject/subject.h"

namespace palpate::pipeline {

extern const std::string_view check_view;    // check_view.html
extern const std::string_view check_script;  // check_view.js and what it is built on

/// One self-contained page of what `palpate check` found. `check`: as in check.json.
void write_check_page(const std::filesystem::path& page, const Subject& subject, const nlohmann::json& check);

}  // namespace palpate::pipeline
