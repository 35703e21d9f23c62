#pragma once

#include <string_view>

namespace palpate::pipeline {

// new_case.yaml of this folder: {section} and {setting} stand for lines, {surface_formats} for their extensions.
extern const std::string_view new_case_text;

// Measurement sets of rigs, rigs/<rig>.txt of this folder: ">>> NAME" and the text of each file.
extern const std::string_view rig_indenter_text, rig_tensile_text, rig_pneumatic_text, rig_tendon_text,
    rig_measurements_text;

}  // namespace palpate::pipeline
