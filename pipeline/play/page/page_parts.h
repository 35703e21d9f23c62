#pragma once

#include <string_view>

// The readable files of this folder and the module, as the build puts them into the program.

namespace palpate::pipeline {

extern const std::string_view play_style;   // play.css
extern const std::string_view play_view;    // play.html: the view and its controls
extern const std::string_view play_script;  // the report's view, the module's frame, and the .js files of this folder
extern const std::string_view play_module;  // the runtime, compiled; in gzip and base64

}  // namespace palpate::pipeline
