#include "pipeline/output/html/charts/svg.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <utility>

#include "pipeline/output/html/escape.h"

namespace palpate::pipeline {
namespace {

/// Spaces between thousands, from five digits before the point on.
std::string with_thousands(const std::string& digits) {
    constexpr std::size_t ungrouped = 4, group = 3;
    constexpr const char* narrow_space = "\u202f";
    const std::size_t first = digits.find_first_of("0123456789"), whole = digits.find('.') - first;
    const std::size_t end = std::min(digits.size(), first + whole);
    if (end - first <= ungrouped) return digits;
    std::string spaced = digits.substr(0, first);
    for (std::size_t i = first; i < digits.size(); ++i) {
        if (i > first && i < end && (end - i) % group == 0) spaced += narrow_space;
        spaced += digits[i];
    }
    return spaced;
}

}  // namespace

double nice_step(double range) {
    const double rough = range / 4, power = std::pow(10.0, std::floor(std::log10(rough)));
    for (const double digit : {1.0, 2.0, 5.0}) {
        if (digit * power >= rough) return digit * power;
    }
    return 10 * power;
}

std::string open_svg(double width, double height, const std::string& description) {
    return fmt::format(R"(<svg viewBox="0 0 {:.0f} {:.0f}" role="img" aria-label="{}">)", width, height,
                       escape(description));
}

std::string words_at(double x, double y, const std::string& words, const char* anchor) {
    return fmt::format(R"(<text x="{:.1f}" y="{:.1f}" text-anchor="{}">{}</text>)", x, y, anchor, escape(words));
}

std::string printed_unit(const std::string& unit) {
    std::string printed;
    for (const char c : unit) printed += c == '*' ? std::string("·") : std::string(1, c);
    return printed;
}

std::string printed_stiffness(const std::string& name) {
    constexpr std::array<std::pair<const char*, const char*>, 7> kinds{{{"elongation", "elongation stiffness"},
                                                                        {"flexion", "bending stiffness"},
                                                                        {"torsion", "torsion stiffness"},
                                                                        {"flexion_2", "bending stiffness, 2nd plane"},
                                                                        {"shear", "shear stiffness"},
                                                                        {"shear_2", "shear stiffness, 2nd plane"},
                                                                        {"volume", "volume stiffness"}}};
    const std::size_t colon = name.find(':');
    const auto* kind = std::ranges::find(kinds, name.substr(0, colon), [](const auto& one) { return one.first; });
    if (kind == kinds.end()) return name;
    if (colon == std::string::npos) return kind->second;
    const std::size_t number = std::min(name.find_first_of("0123456789", colon), name.size());  // "link17"
    return fmt::format("{}, {} {}", kind->second, name.substr(colon + 1, number - colon - 1), name.substr(number));
}

std::string plain_number(double value, int digits) {
    constexpr double most = 1e9, least = 1e-4;  // beyond, zeros would hide the digits
    const double size = std::abs(value);
    if (!std::isfinite(value) || size >= most || size < least) return fmt::format("{:.{}g}", value, digits);
    const auto place = [](double x) { return static_cast<int>(std::floor(std::log10(std::abs(x)))); };
    const double unit = std::pow(10.0, place(value) + 1 - digits);
    const double rounded = unit * std::round(value / unit);
    std::string text = fmt::format("{:.{}f}", rounded, std::max(0, digits - 1 - place(rounded)));
    if (text.find('.') != std::string::npos) {
        text.erase(text.find_last_not_of('0') + 1);
        if (text.back() == '.') text.pop_back();
    }
    return with_thousands(text);
}

double width_of(const std::string& words) {
    constexpr double letter = 6.4;
    const auto letters =
        std::ranges::count_if(words, [](char c) { return (static_cast<unsigned char>(c) & 0xC0) != 0x80; });
    return letter * static_cast<double>(letters);
}

std::string stroke(double x1, double y1, double x2, double y2, const char* style) {
    return fmt::format(R"(<line x1="{:.1f}" y1="{:.1f}" x2="{:.1f}" y2="{:.1f}" {}/>)", x1, y1, x2, y2, style);
}

}  // namespace palpate::pipeline
