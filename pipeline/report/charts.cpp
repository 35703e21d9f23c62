#include "pipeline/report/charts.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "pipeline/report/escape.h"

namespace palpate::pipeline {
namespace {

constexpr double width = 460, left = 56, right = 28;  // [px]

/// A step of 1, 2 or 5 times a power of ten that cuts the range in about four.
double nice_step(double range) {
    const double rough = range / 4, power = std::pow(10.0, std::floor(std::log10(rough)));
    for (const double digit : {1.0, 2.0, 5.0}) {
        if (digit * power >= rough) return digit * power;
    }
    return 10 * power;
}

std::string text(double x, double y, const std::string& words, const char* anchor = "start") {
    return fmt::format(R"(<text x="{:.1f}" y="{:.1f}" text-anchor="{}">{}</text>)", x, y, anchor, escape(words));
}

std::string line(double x1, double y1, double x2, double y2, const char* style) {
    return fmt::format(R"(<line x1="{:.1f}" y1="{:.1f}" x2="{:.1f}" y2="{:.1f}" {}/>)", x1, y1, x2, y2, style);
}

std::string open(double height, const std::string& title) {
    return fmt::format(R"(<svg viewBox="0 0 {} {:.0f}" role="img" aria-label="{}">)", width, height, escape(title));
}

constexpr double top = 30, bottom = 200;  // of bars [px]

/// Grid lines and numbers from 0 to `highest`; `scale`: pixels a unit.
std::string value_axis(double highest, double& scale) {
    const double step = nice_step(highest);
    scale = (bottom - top) / (std::ceil(highest / step) * step);
    std::string svg;
    for (double tick = 0; tick <= highest + step; tick += step) {
        const double y = bottom - scale * tick;
        if (y < top - 1) break;
        svg += line(left, y, width - right, y, R"(stroke="#d8dee5")") +
               text(left - 6, y + 4, fmt::format("{:g}", tick), "end");
    }
    return svg;
}

std::string bar_svg(const Bar& bar, double x, double bar_width, double scale, const std::string& unit) {
    return fmt::format(
        R"(<rect class="bar{}" x="{:.1f}" y="{:.1f}" width="{:.1f}" height="{:.1f}"><title>{}: {:.3g} {}</title></rect>)",
        bar.highlighted ? " held-out" : "", x, bottom - scale * bar.value, bar_width, scale * bar.value,
        escape(bar.label), bar.value, escape(unit));
}

}  // namespace

std::string bar_chart(const std::vector<Bar>& bars, const std::string& title, const std::string& unit) {
    double highest = 0, scale = 1;
    for (const Bar& bar : bars) highest = std::max(highest, bar.value);
    if (bars.empty() || highest <= 0) return {};
    std::string svg = open(bottom + 20, title) + text(0, 16, title + " [" + unit + "]") + value_axis(highest, scale);
    const double pitch = (width - left - right) / static_cast<double>(bars.size());
    for (std::size_t i = 0; i < bars.size(); ++i) {
        svg += bar_svg(bars[i], left + pitch * (static_cast<double>(i) + 0.1), 0.8 * pitch, scale, unit);
    }
    return svg + "</svg>";
}

std::string group_chart(const std::vector<BarGroup>& groups, const std::string& title, const std::string& unit) {
    double highest = 0, scale = 1;
    for (const BarGroup& group : groups) {
        for (const Bar& bar : group.bars) highest = std::max(highest, bar.value);
    }
    if (groups.empty() || highest <= 0) return {};
    std::string svg = open(bottom + 36, title) + text(0, 16, title + " [" + unit + "]") + value_axis(highest, scale);
    const double pitch = (width - left - right) / static_cast<double>(groups.size());
    for (std::size_t g = 0; g < groups.size(); ++g) {
        const double start = left + pitch * (static_cast<double>(g) + 0.15);
        const double bar_width = 0.7 * pitch / static_cast<double>(groups[g].bars.size());
        for (std::size_t b = 0; b < groups[g].bars.size(); ++b) {
            const Bar& bar = groups[g].bars[b];
            const double x = start + bar_width * static_cast<double>(b);
            svg +=
                bar_svg(bar, x + 0.04 * bar_width, 0.92 * bar_width, scale, unit) +
                text(x + 0.5 * bar_width, bottom - scale * bar.value - 4, fmt::format("{:.3g}", bar.value), "middle");
        }
        svg += text(start + 0.35 * pitch, bottom + 18, groups[g].label, "middle");
    }
    return svg + "</svg>";
}

std::string share_bar(const std::vector<Share>& shares, const std::string& title) {
    constexpr double long_width = 920, bar_height = 34;
    std::string svg = fmt::format(R"(<svg viewBox="0 0 {} 70" role="img" aria-label="{}">)", long_width, escape(title));
    double x = 0, key = 0;
    for (const Share& share : shares) {
        svg += fmt::format(R"(<rect x="{:.1f}" y="0" width="{:.1f}" height="{}" fill="{}"><title>{}</title></rect>)", x,
                           long_width * share.value, bar_height, share.colour, escape(share.label));
        x += long_width * share.value;
        const std::string words = fmt::format("{} {:.1f} %", share.label, 100 * share.value);
        svg += fmt::format(R"(<rect x="{:.1f}" y="50" width="12" height="12" fill="{}"/>)", key, share.colour) +
               text(key + 18, 61, words);
        key += long_width / static_cast<double>(shares.size());
    }
    return svg + "</svg>";
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
    std::string svg = open(lowest + 20, title) + text(0, 16, title + " [" + unit + "]");
    for (double tick = low; tick <= high * 1.001; tick *= 10) {
        svg += line(x(tick), top, x(tick), lowest, R"(stroke="#d8dee5")") +
               text(x(tick), lowest + 14, fmt::format("{:g}", tick), "middle");
    }
    for (std::size_t i = 0; i < intervals.size(); ++i) {
        const Interval& v = intervals[i];
        const double y = top + row * (static_cast<double>(i) + 0.6);
        svg += text(0, y + 4, v.label);
        svg += line(x(v.prior_low), y, x(v.prior_high), y, R"(stroke="#d8dee5" stroke-width="8")");
        svg += line(x(v.low), y, x(v.high), y, R"(stroke="#2a6f97" stroke-width="3")");
        svg += fmt::format(R"(<circle cx="{:.1f}" cy="{:.1f}" r="4" fill="#2a6f97"><title>{:.4g} {}</title></circle>)",
                           x(v.middle), y, v.middle, escape(unit));
    }
    return svg + "</svg>";
}

}  // namespace palpate::pipeline
