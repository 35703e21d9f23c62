#pragma once

#include <nlohmann/json.hpp>
#include <regex>
#include <string>

#include "pipeline/command_line/terminal/printed_units.h"

namespace palpate::pipeline {

/// A text as it may stand in HTML and SVG, attributes included, with its units as they are printed.
inline std::string escape(const std::string& text) {
    std::string safe;
    for (const char c : with_printed_units(text)) {
        switch (c) {
            case '&':
                safe += "&amp;";
                break;
            case '<':
                safe += "&lt;";
                break;
            case '>':
                safe += "&gt;";
                break;
            case '"':
                safe += "&quot;";
                break;
            case '\'':
                safe += "&#39;";
                break;
            default:
                safe += c;
        }
    }
    return safe;
}

/// As escape, of running text: no line ends between a name, its "=" and its number, or a number and its unit.
inline std::string prose(const std::string& text) {
    static const std::regex equals(" = "), of_sd("± "),
        unit(R"(([0-9)]) (%|MPa|kPa|N|kg|mm|m|s|Hz|rad|degrees|sigmas?)(?![A-Za-z]))");
    std::string bound = std::regex_replace(escape(text), equals, "\u00a0=\u00a0");
    bound = std::regex_replace(bound, of_sd, "±\u00a0");
    return std::regex_replace(bound, unit, "$1\u00a0$2");
}

/// JSON as it may stand in a script element: no "</script>" ends it.
inline std::string as_script_data(const nlohmann::json& data) {
    std::string safe;
    for (const char c : data.dump()) safe += c == '<' ? "\\u003c" : std::string(1, c);
    return safe;
}

}  // namespace palpate::pipeline
