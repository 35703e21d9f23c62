#pragma once

#include <string>

namespace palpate::pipeline {

/// A text for people with its units as they are printed: "mm/s²" for "mm/s^2", "N·mm" for "N*mm". Files keep the ASCII
/// form, which every program reads.
std::string with_printed_units(const std::string& text);

}  // namespace palpate::pipeline
