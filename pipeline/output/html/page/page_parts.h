#pragma once

#include <string_view>

// The readable files of this folder and of view/, as the build puts them into the program.

namespace palpate::pipeline {

extern const std::string_view page_style;      // page.css
extern const std::string_view page_view;       // view/view.html: the three-dimensional view and its controls
extern const std::string_view page_script;     // the .js files in the order of their use
extern const std::string_view density_script;  // densities.js
extern const std::string_view paraview_text;   // view.py

}  // namespace palpate::pipeline
