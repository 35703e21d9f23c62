#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace palpate::pipeline {

/// Points (x, y) with a name, as a line, dots, or both.
struct ChartLine {
    std::string label;
    std::vector<std::pair<double, double>> points;
    enum class Drawn { both, line, dots } drawn = Drawn::both;
};

/// Curves over a common axis, as SVG, the y axis from their least value to a round one above the largest; "" without
/// two places along the axis.
std::string line_chart(const std::vector<ChartLine>& curves, const std::string& title, const std::string& across);

struct Bar {
    std::string label;  // shown when pointed at; up to its comma below the bar, where there is room
    double value;
    bool highlighted;
};

/// Bars side by side with a value axis, as SVG. `noise`: a line across them at that value.
std::string bar_chart(const std::vector<Bar>& bars, const std::string& title, const std::string& unit,
                      std::optional<double> noise = {});

/// Bars that belong together, with a label below.
struct BarGroup {
    std::string label;
    std::vector<Bar> bars;
};

/// Groups of bars with their values above, as SVG; "" without groups.
std::string group_chart(const std::vector<BarGroup>& groups, const std::string& title, const std::string& unit);

/// A part of a whole.
struct BarSegment {
    std::string label;
    double value;        // [0, 1]
    std::string colour;  // as in CSS
};

/// One bar made of shares, with its key below, as HTML.
std::string share_bar(const std::vector<BarSegment>& shares, const std::string& title);

/// A value known up to an interval, before and after measuring.
struct Interval {
    std::string label;
    double low, middle, high;      // posterior: 2.5 %, median, 97.5 %
    double prior_low, prior_high;  // prior: 95 %
};

/// Posterior intervals over prior ones, on a logarithmic axis, as SVG; all values > 0.
std::string interval_chart(const std::vector<Interval>& intervals, const std::string& title, const std::string& unit);

}  // namespace palpate::pipeline
