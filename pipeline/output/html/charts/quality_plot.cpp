#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "pipeline/output/html/escape.h"
#include "pipeline/output/results/quality.h"

namespace palpate::pipeline {
namespace {

constexpr double width = 640, height = 420, left = 64, right = 110, top = 44, bottom = 52;  // [px]

/// A logarithmic axis from `low` to `high`, drawn between two places.
struct Axis {
    double low, high, from, to;
    double operator()(double value) const {
        return from + (to - from) * std::log(std::clamp(value, low, high) / low) / std::log(high / low);
    }
    /// 1, 2 and 5 times powers of ten.
    std::vector<double> ticks() const {
        std::vector<double> result;
        for (double power = std::pow(10, std::floor(std::log10(low))); power <= high; power *= 10) {
            for (const double digit : {1., 2., 5.}) {
                const double tick = digit * power;
                if (tick >= low * 0.999 && tick <= high * 1.001) result.push_back(tick);
            }
        }
        return result;
    }
};

std::string text(double x, double y, const std::string& words, const char* anchor) {
    return fmt::format(R"(<text x="{:.1f}" y="{:.1f}" text-anchor="{}">{}</text>)", x, y, anchor, escape(words));
}

std::string grid(const Axis& x, const Axis& y) {
    std::string svg;
    const char* line = R"(<line x1="{:.1f}" y1="{:.1f}" x2="{:.1f}" y2="{:.1f}" stroke="#d8dee5"/>)";
    for (const double tick : x.ticks()) {
        svg += fmt::format(fmt::runtime(line), x(tick), y.from, x(tick), y.to) +
               text(x(tick), y.from + 18, fmt::format("{:g}", tick), "middle");
    }
    for (const double tick : y.ticks()) {
        svg += fmt::format(fmt::runtime(line), x.from, y(tick), x.to, y(tick)) +
               text(x.from - 8, y(tick) + 4, fmt::format("{:g}", tick), "end");
    }
    return svg;
}

struct Curve {
    const char *name, *colour;
    double ErrorSummary::*error;
};

std::string drawn(const Curve& curve, const std::vector<QualityStep>& steps, const Axis& x, const Axis& y) {
    std::string points, dots;
    for (const QualityStep& step : steps) {
        const double percent = 100 * step.error.*curve.error;
        const double px = x(step.spheres), py = y(percent);
        points += fmt::format("{:.1f},{:.1f} ", px, py);
        dots += fmt::format(
            R"(<circle cx="{:.1f}" cy="{:.1f}" r="{}" fill="{}"><title>{} spheres: {} {:.2f} %</title></circle>)", px,
            py, step.is_own ? 6 : 3.5, curve.colour, step.spheres, curve.name, percent);
    }
    return fmt::format(R"(<polyline points="{}" fill="none" stroke="{}" stroke-width="2"/>)", points, curve.colour) +
           dots;
}

}  // namespace

std::string quality_plot(const Quality& quality, const std::string& name) {
    const std::vector<QualityStep>& steps = quality.steps;
    if (steps.empty()) return {};
    const Curve curves[] = {{"90th percentile", "#8d99ae", &ErrorSummary::p90},
                            {"rms", "#c1121f", &ErrorSummary::rms},
                            {"median", "#2a6f97", &ErrorSummary::median}};
    double least = 1e300, most = 0;  // [%]
    for (const QualityStep& step : steps) {
        for (const Curve& curve : curves) {
            const double percent = 100 * step.error.*curve.error;
            least = std::min(least, percent);
            most = std::max(most, percent);
        }
    }
    const Axis x{0.8 * steps.front().spheres, 1.25 * steps.back().spheres, left, width - right};
    const Axis y{std::max(0.7 * least, 1e-3), std::max(1.4 * most, 2e-3), height - bottom, top};
    std::string svg = fmt::format(
        R"(<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {0} {1}" width="{0}" height="{1}" font-family="sans-serif" font-size="12"><!-- palpate quality --><rect width="{0}" height="{1}" fill="white"/>)",
        width, height);
    svg += text(left, 22, fmt::format("{}: error against finite elements, held-out probes [%]", name), "start");
    svg += grid(x, y) + text((x.from + x.to) / 2, height - 12, "free spheres (large dots: the model)", "middle");
    double key = top + 10;
    for (const Curve& curve : curves) {
        svg += drawn(curve, steps, x, y);
        svg += fmt::format(R"(<g fill="{}">{}</g>)", curve.colour, text(width - right + 10, key, curve.name, "start"));
        key += 18;
    }
    return svg + "</svg>\n";
}

}  // namespace palpate::pipeline
