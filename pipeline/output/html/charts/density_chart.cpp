#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "pipeline/analysis/density.h"
#include "pipeline/output/html/charts/svg.h"

namespace palpate::pipeline {
namespace {

constexpr double width = 320, height = 214, left = 46, right = 14, top = 44, bottom = 168;  // [px]
constexpr double logarithmic_from = 5;  // ratio of an axis' ends, from which its ticks go by powers of ten
constexpr double few_decades = 2.5;

/// From ln x and densities to places in the picture.
struct Frame {
    double low, high, highest;
    double x(double ln) const { return left + (width - left - right) * (ln - low) / (high - low); }
    double y(double density) const { return bottom - (bottom - top) * density / highest; }
};

Frame frame_of(const KnownBeforeAndAfter& known) {
    double highest = 0;
    for (const Density* density : {&known.prior, &known.posterior}) {
        for (const auto& [ln, value] : *density) highest = std::max(highest, value);
    }
    return {known.prior.front().first, known.prior.back().first, 1.05 * highest};
}

/// Powers of ten between the ends, and twice and five times these where they are few.
std::vector<double> logarithmic_ticks(double low, double high) {
    std::vector<double> ticks;
    const double decades = std::log10(high / low), step = std::max(1.0, std::ceil(decades / 5));
    for (double power = std::floor(std::log10(low)); power <= std::log10(high); power += step) {
        for (const double digit : {1.0, 2.0, 5.0}) {
            const double tick = digit * std::pow(10.0, power);
            if (tick >= low && tick <= high && (digit == 1 || decades < few_decades)) ticks.push_back(tick);
        }
    }
    return ticks;
}

/// Round values of x between the ends.
std::vector<double> ticks_of(const Frame& frame) {
    const double low = std::exp(frame.low), high = std::exp(frame.high);
    if (high > logarithmic_from * low) return logarithmic_ticks(low, high);
    std::vector<double> ticks;
    const double step = nice_step(high - low);
    for (double i = std::ceil(low / step); i * step <= high; ++i) ticks.push_back(i * step);
    return ticks;
}

std::string axes(const Frame& frame, const std::string& across) {
    std::string svg;
    const double step = nice_step(frame.highest);
    for (double density = 0; density <= frame.highest; density += step) {
        svg += stroke(left, frame.y(density), width - right, frame.y(density), faint_line) +
               words_at(left - 5, frame.y(density) + 4, fmt::format("{:g}", density), "end");
    }
    double free_from = 0;  // numbers do not run into each other
    for (const double tick : ticks_of(frame)) {
        const double x = frame.x(std::log(tick));
        svg += stroke(x, bottom, x, bottom + 4, R"(stroke="#55616d")");
        const std::string number = plain_number(tick, 4);
        const double half = width_of(number) / 2;
        if (x - half < free_from || x + half > width) continue;
        svg += words_at(x, bottom + 17, number, "middle");
        free_from = x + half + 6;
    }
    return svg + words_at(width - right, height - 10, across, "end");
}

/// "14 N/mm (95 %: 6.2–50)", to as many digits as the interval leaves.
std::string known_words(const KnownBeforeAndAfter& known, const std::string& unit) {
    const double ratio = known.high / known.low;
    const int digits = ratio > 1.3 ? 2 : ratio > 1.03 ? 3 : 4;
    return fmt::format("{} {} (95 %: {}–{})", plain_number(known.middle, digits), unit, plain_number(known.low, digits),
                       plain_number(known.high, digits));
}

std::string points_of(const Density& density, const Frame& frame) {
    std::string points;
    for (const auto& [ln, value] : density) points += fmt::format("{:.0f},{:.1f} ", frame.x(ln), frame.y(value));
    return points;
}

}  // namespace

std::string density_chart(const KnownBeforeAndAfter& known) {
    const Frame frame = frame_of(known);
    const std::string unit = known.unit.empty() ? "× start value" : printed_unit(known.unit);
    const std::string words = "median " + known_words(known, unit);
    const std::string filled = fmt::format("{:.1f},{:.1f} ", left, bottom) + points_of(known.posterior, frame) +
                               fmt::format("{:.1f},{:.1f}", width - right, bottom);
    return open_svg(width, height, known.name + ": " + words) + words_at(0, 14, known.name) + words_at(0, 32, words) +
           R"svg(<text transform="translate(11 106) rotate(-90)" text-anchor="middle" class="small">density of ln x</text>)svg" +
           axes(frame, fmt::format("x = {} [{}]", known.name.substr(0, known.name.find_first_of(":,")), unit)) +
           fmt::format(R"(<polygon points="{}" fill="{}" fill-opacity="0.3" stroke="{}" stroke-width="1.5"/>)", filled,
                       posterior_blue, posterior_blue) +
           fmt::format(
               R"(<polyline points="{}" fill="none" stroke="{}" stroke-width="2" stroke-dasharray="6 4"/></svg>)",
               points_of(known.prior, frame), prior_grey);
}

}  // namespace palpate::pipeline
