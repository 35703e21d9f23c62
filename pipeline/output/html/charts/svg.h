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
std::string stroke(double x1, double y1, double x2, double y2, const char* style);

}  // namespace palpate::pipeline
