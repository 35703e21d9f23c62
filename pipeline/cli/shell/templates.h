#pragma once

#include <string_view>

namespace palpate::pipeline {

// new_case.yaml of this folder: {section} and {setting} stand for lines, {surface_formats} for their extensions.
extern const std::string_view new_case_text;

}  // namespace palpate::pipeline
