#pragma once

#include <string>
#include <vector>

namespace palpate::pipeline {

struct Bar {
    std::string label;  // told when pointed at
    double value;
    bool highlighted;
};

/// Bars side by side with a value axis, as SVG.
std::string bar_chart(const std::vector<Bar>& bars, const std::string& title, const std::string& unit);

/// A value known up to an interval, before and after measuring.
struct Interval {
    std::string label;
    double low, middle, high;      // posterior: 2.5 %, mean, 97.5 %
    double prior_low, prior_high;  // prior: 95 %
};

/// Posterior intervals over prior ones, on a logarithmic axis, as SVG; all values > 0.
std::string interval_chart(const std::vector<Interval>& intervals, const std::string& title, const std::string& unit);

}  // namespace palpate::pipeline
