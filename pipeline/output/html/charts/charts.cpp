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
constexpr const char* line_dashes[] = {"", "6 3", "2 3"};  // distinguishable without colour, too

std::string polyline(const std::string& points, std::size_t style) {
    return fmt::format(R"(<polyline points="{}" fill="none" stroke="{}" stroke-width="2" stroke-dasharray="{}"/>)",
                       points, line_colours[style], line_dashes[style]);
}

std::string curve_svg(const ChartLine& curve, const EvenAxis& x, const EvenAxis& y, std::size_t style) {
    std::string points, dots;
    for (const auto& [px, py] : curve.points) {
        points += fmt::format("{:.1f},{:.1f} ", x(px), y(py));
        dots +=
            fmt::format(R"(<circle cx="{:.1f}" cy="{:.1f}" r="3" fill="{}"><title>{} at {:g}: {:.4g}</title></circle>)",
                        x(px), y(py), line_colours[style], escape(curve.label), px, py);
    }
    switch (curve.drawn) {
        case ChartLine::Drawn::dots:
            return dots;
        case ChartLine::Drawn::line:
            return polyline(points, style);
        default:
            return polyline(points, style) + dots;
    }
}

/// The keys of several curves above their chart, in as many rows as they need; a single one is what the title says.
struct ChartKeys {
    std::string svg;
    double end = 30;  // [px]
};

ChartKeys chart_keys(const std::vector<ChartLine>& curves) {
    constexpr double first = 36, sample = 24, gap = 6, apart = 18, row = 16;  // [px]
    if (curves.size() < 2) return {};
    double x = left, y = first;
    std::string svg;
    for (std::size_t i = 0; i < curves.size(); ++i) {
        const std::size_t style = i % std::size(line_colours);
        const double wide = sample + gap + width_of(curves[i].label);
        if (x > left && x + wide > width) {
            x = left;
            y += row;
        }
        svg += curves[i].drawn == ChartLine::Drawn::dots
                   ? fmt::format(R"(<circle cx="{:.1f}" cy="{:.1f}" r="3" fill="{}"/>)", x + sample - gap, y - 4,
                                 line_colours[style])
                   : polyline(fmt::format("{:.1f},{:.1f} {:.1f},{:.1f}", x, y - 4, x + sample, y - 4), style);
        svg += words_at(x + sample + gap, y, curves[i].label);
        x += wide + apart;
    }
    return {svg, y};
}

/// What stands below bars: the beginnings of their labels, without the word that all begin with; that word.
struct BarNames {
    std::vector<std::string> names;
    std::string word;
};

BarNames bar_names(const std::vector<Bar>& bars) {
    BarNames result;
    for (const Bar& bar : bars) result.names.push_back(bar.label.substr(0, bar.label.find(',')));
    const std::string word = result.names.front().substr(0, result.names.front().find(' ') + 1);  // "probe "
    if (word.empty() || !std::ranges::all_of(result.names, [&](const auto& name) { return name.starts_with(word); }))
        return result;
    for (std::string& name : result.names) name.erase(0, word.size());
    result.word = word.substr(0, word.size() - 1);
    return result;
}

/// Of bars alike in a row the first, and of these every so manieth that there is room for all.
std::string names_below(const std::vector<Bar>& bars, double pitch) {
    constexpr double apart = 6;  // [px]
    const auto [names, word] = bar_names(bars);
    std::vector<std::size_t> firsts;
    double widest = 0;
    for (std::size_t i = 0; i < names.size(); ++i) {
        if (i == 0 || names[i] != names[i - 1]) firsts.push_back(i);
        widest = std::max(widest, width_of(names[i]));
    }
    const double room = pitch * static_cast<double>(names.size()) / static_cast<double>(firsts.size());
    const auto every = static_cast<std::size_t>(std::max(1.0, std::ceil((widest + apart) / room)));
    std::string svg = words_at(width - right, bottom + 34, word, "end");
    for (std::size_t f = 0; f < firsts.size(); f += every)
        svg += words_at(left + pitch * (static_cast<double>(firsts[f]) + 0.5), bottom + 18, names[firsts[f]], "middle");
    return svg;
}

}  // namespace

std::string line_chart(const std::vector<ChartLine>& curves, const std::string& title, const std::string& across) {
    constexpr double below_keys = 14;  // [px]
    const ChartKeys keys = chart_keys(curves);
    EvenAxis x{1e300, -1e300, left, width - right}, y{1e300, -1e300, bottom, keys.end + below_keys};
    for (const ChartLine& curve : curves) {
        for (const auto& [px, py] : curve.points) {
            x.take(px);
            y.take(py);
        }
    }
    if (!(x.high > x.low)) return {};
    y.take(y.low >= 0 && y.low < 0.5 * y.high ? 0 : y.low);
    if (!(y.high > y.low)) y.high = y.low + (y.low == 0 ? 1 : 0.1 * std::abs(y.low));
    const double step = nice_step(y.high - y.low);
    y.high = step * std::ceil(y.high / step - 1e-9);
    std::string svg = open(bottom + 40, title) + words_at(0, 16, title) + keys.svg;
    for (const double tick : y.ticks()) {
        svg += stroke(left, y(tick), width - right, y(tick), R"(stroke="#d8dee5")") +
               words_at(left - 6, y(tick) + 4, fmt::format("{:g}", tick), "end");
    }
    for (const double tick : x.ticks()) svg += words_at(x(tick), bottom + 18, fmt::format("{:g}", tick), "middle");
    svg += words_at(width - right, bottom + 34, across, "end");
    for (std::size_t i = 0; i < curves.size(); ++i) svg += curve_svg(curves[i], x, y, i % std::size(line_colours));
    return svg + "</svg>";
}

std::string bar_chart(const std::vector<Bar>& bars, const std::string& title, const std::string& unit,
                      std::optional<double> noise) {
    double highest = noise.value_or(0), scale = 1;
    for (const Bar& bar : bars) highest = std::max(highest, bar.value);
    if (bars.empty() || highest <= 0) return {};
    std::string svg = open(bottom + 40, title) +
                      words_at(0, 16, title + " [" + unit + "]" + (noise ? "; dotted: noise" : "")) +
                      value_axis(highest, scale);
    const double pitch = (width - left - right) / static_cast<double>(bars.size());
    for (std::size_t i = 0; i < bars.size(); ++i) {
        svg += bar_svg(bars[i], left + pitch * (static_cast<double>(i) + 0.1), 0.8 * pitch, scale, unit);
    }
    svg += names_below(bars, pitch);
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
    constexpr double row = 18, least_label = 130, most_label = 240;
    double low = 1e300, high = 0, label_width = least_label;
    for (const Interval& i : intervals) {
        label_width = std::clamp(width_of(i.label) + 12, label_width, most_label);
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
               words_at(x(tick), lowest + 14, plain_number(tick), "middle");
    }
    for (std::size_t i = 0; i < intervals.size(); ++i) {
        const Interval& v = intervals[i];
        const double y = top + row * (static_cast<double>(i) + 0.6);
        svg += words_at(0, y + 4, v.label);
        svg += stroke(x(v.prior_low), y, x(v.prior_high), y, R"(stroke="#d8dee5" stroke-width="8")");
        svg += stroke(x(v.low), y, x(v.high), y, R"(stroke="#2a6f97" stroke-width="3")");
        svg += fmt::format(R"(<circle cx="{:.1f}" cy="{:.1f}" r="4" fill="#2a6f97"><title>{} {}</title></circle>)",
                           x(v.middle), y, plain_number(v.middle), escape(printed));
    }
    return svg + "</svg>";
}

}  // namespace palpate::pipeline
