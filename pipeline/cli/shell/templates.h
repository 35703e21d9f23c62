#pragma once

#include <string_view>

namespace palpate::pipeline {

extern const std::string_view new_case_text;  // new_case.yaml of this folder: {section} and {setting} stand for lines

}  // namespace palpate::pipeline
