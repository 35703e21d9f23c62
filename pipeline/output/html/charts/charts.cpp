#include "pipeline/output/html/charts/charts.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "pipeline/output/html/charts/svg.h"
#include "pipeline/output/html/escape.h"

namespace palpate::pipeline {
namespace {

constexpr double width = 460, left = 56, right = 28;  // [px]

std::string open(double height, const std::string& title) { return open_svg(width, height, title); }

constexpr double top = 30, bottom = 200;  // of bars [px]

/// An even axis between two places [px].
struct EvenAxis {
    double low, high, from, to;
    void take(double value) {
        low = std::min(low, value);
        high = std::max(high, value);
    }
    double operator()(double value) const { return from + (to - from) * (value - low) / (high - low); }
    std::vector<double> ticks() const {
        const double step = nice_step(high - low);
        std::vector<double> result;
        for (double i = std::ceil(low / step - 1e-9); i * step <= high + 1e-9 * step; ++i)
            result.push_back(i * step + 0.0);  // no "-0"
        return result;
    }
};

/// Grid lines and numbers from 0 to `highest`; `scale`: pixels a unit.
std::string value_axis(double highest, double& scale) {
    const double step = nice_step(highest);
    scale = (bottom - top) / (std::ceil(highest / step) * step);
    std::string svg;
    for (double tick = 0; tick <= highest + step; tick += step) {
        const double y = bottom - scale * tick;
        if (y < top - 1) break;
        svg += stroke(left, y, width - right, y, R"(stroke="#d8dee5")") +
               words_at(left - 6, y + 4, fmt::format("{:g}", tick), "end");
    }
    return svg;
}

std::string bar_svg(const Bar& bar, double x, double bar_width, double scale, const std::string& unit) {
    return fmt::format(
        R"(<rect class="bar{}" x="{:.1f}" y="{:.1f}" width="{:.1f}" height="{:.1f}"><title>{}: {:.3g} {}</title></rect>)",
        bar.highlighted ? " held-out" : "", x, bottom - scale * bar.value, bar_width, scale * bar.value,
        escape(bar.label), bar.value, escape(unit));
}

constexpr const char* line_colours[] = {"#2a6f97", "#c8741a", "#55616d"};
constexpr const char* line_dashes[] = {"", "6 3", "2 3"};  // told apart without colour, too

std::string curve_svg(const ChartLine& curve, const EvenAxis& x, const EvenAxis& y, std::size_t number) {
    const std::size_t style = number % std::size(line_colours);
    std::string points, dots;
    for (const auto& [px, py] : curve.points) {
        points += fmt::format("{:.1f},{:.1f} ", x(px), y(py));
        dots +=
            fmt::format(R"(<circle cx="{:.1f}" cy="{:.1f}" r="3" fill="{}"><title>{} at {:g}: {:.4g}</title></circle>)",
                        x(px), y(py), line_colours[style], escape(curve.label), px, py);
    }
    if (curve.drawn == ChartLine::Drawn::dots) return dots;
    if (curve.drawn == ChartLine::Drawn::line) dots.clear();
    return fmt::format(R"(<polyline points="{}" fill="none" stroke="{}" stroke-width="2" stroke-dasharray="{}"/>)",
                       points, line_colours[style], line_dashes[style]) +
           dots;
}

}  // namespace

std::string line_chart(const std::vector<ChartLine>& curves, const std::string& title, const std::string& across) {
    EvenAxis x{1e300, -1e300, left, width - right}, y{1e300, -1e300, bottom, top + 18};
    for (const ChartLine& curve : curves) {
        for (const auto& [px, py] : curve.points) {
            x.take(px);
            y.take(py);
        }
    }
    if (!(x.high > x.low)) return {};
    y.take(y.low >= 0 && y.low < 0.5 * y.high ? 0 : y.low);
    if (!(y.high > y.low)) y.high = y.low + (y.low == 0 ? 1 : 0.1 * std::abs(y.low));
    std::string svg = open(bottom + 40, title) + words_at(0, 16, title);
    for (const double tick : y.ticks()) {
        svg += stroke(left, y(tick), width - right, y(tick), R"(stroke="#d8dee5")") +
               words_at(left - 6, y(tick) + 4, fmt::format("{:g}", tick), "end");
    }
    for (const double tick : x.ticks()) svg += words_at(x(tick), bottom + 18, fmt::format("{:g}", tick), "middle");
    svg += words_at(width - right, bottom + 34, across, "end");
    for (std::size_t i = 0; i < curves.size(); ++i) {
        svg += curve_svg(curves[i], x, y, i);
        if (curves.size() < 2) continue;
        const double key = left + 150.0 * static_cast<double>(i);
        ChartLine sample{.label = curves[i].label, .points = {{0, 0}, {0.5, 0}, {1, 0}}, .drawn = curves[i].drawn};
        if (sample.drawn == ChartLine::Drawn::both) sample.drawn = ChartLine::Drawn::line;
        svg += curve_svg(sample, {0, 1, key, key + 24}, {0, 1, 32, 32}, i) + words_at(key + 30, 36, curves[i].label);
    }
    return svg + "</svg>";
}

std::string bar_chart(const std::vector<Bar>& bars, const std::string& title, const std::string& unit,
                      std::optional<double> noise) {
    double highest = noise.value_or(0), scale = 1;
    for (const Bar& bar : bars) highest = std::max(highest, bar.value);
    if (bars.empty() || highest <= 0) return {};
    std::string svg = open(bottom + 20, title) +
                      words_at(0, 16, title + " [" + unit + "]" + (noise ? "; dotted: noise" : "")) +
                      value_axis(highest, scale);
    const double pitch = (width - left - right) / static_cast<double>(bars.size());
    for (std::size_t i = 0; i < bars.size(); ++i) {
        svg += bar_svg(bars[i], left + pitch * (static_cast<double>(i) + 0.1), 0.8 * pitch, scale, unit);
    }
    if (noise) {
        const double y = bottom - scale * *noise;
        svg += stroke(left, y, width - right, y, R"(stroke="#1c2530" stroke-dasharray="2 3")");
    }
    return svg + "</svg>";
}

std::string group_chart(const std::vector<BarGroup>& groups, const std::string& title, const std::string& unit) {
    double highest = 0, scale = 1;
    for (const BarGroup& group : groups) {
        for (const Bar& bar : group.bars) highest = std::max(highest, bar.value);
    }
    if (groups.empty() || highest <= 0) return {};
    std::string svg =
        open(bottom + 36, title) + words_at(0, 16, title + " [" + unit + "]") + value_axis(highest, scale);
    const double pitch = (width - left - right) / static_cast<double>(groups.size());
    for (std::size_t g = 0; g < groups.size(); ++g) {
        const double start = left + pitch * (static_cast<double>(g) + 0.15);
        const double bar_width = 0.7 * pitch / static_cast<double>(groups[g].bars.size());
        for (std::size_t b = 0; b < groups[g].bars.size(); ++b) {
            const Bar& bar = groups[g].bars[b];
            const double x = start + bar_width * static_cast<double>(b);
            svg += bar_svg(bar, x + 0.04 * bar_width, 0.92 * bar_width, scale, unit) +
                   words_at(x + 0.5 * bar_width, bottom - scale * bar.value - 4, fmt::format("{:.3g}", bar.value),
                            "middle");
        }
        svg += words_at(start + 0.35 * pitch, bottom + 18, groups[g].label, "middle");
    }
    return svg + "</svg>";
}

std::string share_bar(const std::vector<BarSegment>& shares, const std::string& title) {
    std::string bar, key;
    for (const BarSegment& share : shares) {
        bar += fmt::format(R"(<span style="width:{:.2f}%;background:{}"></span>)", 100 * share.value, share.colour);
        key += fmt::format(R"(<li><i style="background:{}"></i>{} <b>{:.1f} %</b></li>)", share.colour,
                           escape(share.label), 100 * share.value);
    }
    return fmt::format(R"(<div class="shares" role="img" aria-label="{}">{}</div><ul class="key">{}</ul>)",
                       escape(title), bar, key);
}

std::string interval_chart(const std::vector<Interval>& intervals, const std::string& title, const std::string& unit) {
    if (intervals.empty()) return {};
    constexpr double row = 18, label_width = 130;
    double low = 1e300, high = 0;
    for (const Interval& i : intervals) {
        low = std::min(low, i.low);
        high = std::max(high, i.high);
    }
    // The axis holds the posteriors with a decade round them: wide priors run out of the picture.
    low = std::pow(10.0, std::floor(std::log10(low) - 0.3));
    high = std::pow(10.0, std::ceil(std::log10(high) + 0.3));
    const double lowest = top + row * static_cast<double>(intervals.size()) + 4;
    const auto x = [&](double value) {
        const double share = std::log(std::clamp(value, low, high) / low) / std::log(high / low);
        return label_width + share * (width - label_width - right);
    };
    const std::string printed = printed_unit(unit);
    std::string svg = open(lowest + 20, title) + words_at(0, 16, title + " [" + printed + "]");
    for (double tick = low; tick <= high * 1.001; tick *= 10) {
        svg += stroke(x(tick), top, x(tick), lowest, R"(stroke="#d8dee5")") +
               words_at(x(tick), lowest + 14, fmt::format("{:g}", tick), "middle");
    }
    for (std::size_t i = 0; i < intervals.size(); ++i) {
        const Interval& v = intervals[i];
        const double y = top + row * (static_cast<double>(i) + 0.6);
        svg += words_at(0, y + 4, v.label);
        svg += stroke(x(v.prior_low), y, x(v.prior_high), y, R"(stroke="#d8dee5" stroke-width="8")");
        svg += stroke(x(v.low), y, x(v.high), y, R"(stroke="#2a6f97" stroke-width="3")");
        svg += fmt::format(R"(<circle cx="{:.1f}" cy="{:.1f}" r="4" fill="#2a6f97"><title>{:.4g} {}</title></circle>)",
                           x(v.middle), y, v.middle, escape(printed));
    }
    return svg + "</svg>";
}

}  // namespace palpate::pipeline
