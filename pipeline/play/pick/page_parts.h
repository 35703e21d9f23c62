#pragma once

#include <string_view>

// The files of this folder, as the build puts them into the program.

namespace palpate::pipeline {

extern const std::string_view pick_style;   // play.css of the page of a model, and pick.css
extern const std::string_view pick_view;    // pick.html: the view and its controls
extern const std::string_view pick_script;  // the view's .js files and those of this folder

}  // namespace palpate::pipeline
