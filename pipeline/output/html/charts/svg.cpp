#include "pipeline/output/html/charts/svg.h"

#include <fmt/format.h>

#include <cmath>

#include "pipeline/output/html/escape.h"

namespace palpate::pipeline {

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

std::string stroke(double x1, double y1, double x2, double y2, const char* style) {
    return fmt::format(R"(<line x1="{:.1f}" y1="{:.1f}" x2="{:.1f}" y2="{:.1f}" {}/>)", x1, y1, x2, y2, style);
}

}  // namespace palpate::pipeline
