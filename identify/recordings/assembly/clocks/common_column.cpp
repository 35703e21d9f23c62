#include "identify/recordings/assembly/clocks/common_column.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "mesh/errors.h"

namespace palpate::identify {
namespace {

/// The signal as one that never turns back. @throws InvalidInput where it does by more than its noise.
Signal checked_monotone(const std::string& name, const CommonColumn& column) {
    constexpr double off = 0.02;  // of the range, rms: what is left is no noise of a sensor
    const Signal& signal = column.signal;
    Signal fit = monotone(signal);
    const double range = signal.values.maxCoeff() - signal.values.minCoeff();
    const double rms =
        std::sqrt((fit.values - signal.values).squaredNorm() / static_cast<double>(signal.values.size()));
    if (rms > off * range)
        throw InvalidInput(
            fmt::format("{}: the common column '{}' goes up and down, and its values tell no times. "
                        "Merge by clock: {{lag: auto}}.",
                        column.file, name));
    return fit;
}

/// Times over values. @pre monotone
Signal inverted(const Signal& signal) {
    std::vector<double> values, times;
    const bool falls = signal.values[signal.values.size() - 1] < signal.values[0];
    for (Eigen::Index begin = 0; begin < signal.values.size();) {
        Eigen::Index end = begin;
        while (end < signal.values.size() && signal.values[end] == signal.values[begin]) ++end;
        values.push_back(signal.values[begin]);
        times.push_back((signal.times[begin] + signal.times[end - 1]) / 2);
        begin = end;
    }
    if (falls) {
        std::ranges::reverse(values);
        std::ranges::reverse(times);
    }
    return {Eigen::Map<Eigen::VectorXd>(values.data(), std::ssize(values)),
            Eigen::Map<Eigen::VectorXd>(times.data(), std::ssize(times))};
}

}  // namespace

Signal clock_by_common(const std::string& name, const CommonColumn& reference, const CommonColumn& other) {
    const Signal own = checked_monotone(name, reference), told = checked_monotone(name, other);
    const Signal inverse = inverted(own);
    Signal clock = without_gaps({told.times, told.values.unaryExpr([&](double v) { return value_at(inverse, v); })});
    if (clock.times.size() < 2)
        throw InvalidInput(
            fmt::format("{}: '{}' goes from {:.4g} to {:.4g} here and from {:.4g} to {:.4g} in {}: they "
                        "have nothing in common. Are the units the same?",
                        other.file, name, other.signal.values.minCoeff(), other.signal.values.maxCoeff(),
                        reference.signal.values.minCoeff(), reference.signal.values.maxCoeff(), reference.file));
    return clock;
}

}  // namespace palpate::identify
