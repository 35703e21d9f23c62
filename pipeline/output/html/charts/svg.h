#pragma once

#include <string>

namespace palpate::pipeline {

// Pieces of the page's charts; lengths in pixels of their own frame.

inline constexpr const char* posterior_blue = "#2a6f97";
inline constexpr const char* prior_grey = "#55616d";
inline constexpr const char* faint_line = R"(stroke="#d8dee5")";

/// A step of 1, 2 or 5 times a power of ten that cuts a range in about four.
double nice_step(double range);

/// The beginning of a picture that a reader without eyes is `description`.
std::string open_svg(double width, double height, const std::string& description);
std::string words_at(double x, double y, const std::string& words, const char* anchor = "start");
/// A unit as it is printed, "N·mm/rad" for "N*mm/rad".
std::string printed_unit(const std::string& unit);
/// A stiffness as it is printed, "bending stiffness, link 17" for "flexion:link17"; any other name as it is.
std::string printed_stiffness(const std::string& name);
/// So many significant digits, as people write them: "0.13", "1180", "406 000"; none before the point are dropped.
std::string plain_number(double value, int digits = 3);
/// About how wide words are in a chart [px].
double width_of(const std::string& words);
std::string stroke(double x1, double y1, double x2, double y2, const char* style);

}  // namespace palpate::pipeline
