#include "identify/recordings/assembly/clocks/signal.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "mesh/numbers/median.h"

namespace palpate::identify {
namespace {

double median(std::vector<double> values) { return values.empty() ? 0 : mesh::upper_median(std::move(values)); }

/// Runs of the rising fit: mean and length of each.
std::vector<std::pair<double, Eigen::Index>> rising_runs(const Eigen::VectorXd& values) {
    std::vector<std::pair<double, Eigen::Index>> runs;
    runs.reserve(static_cast<std::size_t>(values.size()));
    for (const double value : values) {
        runs.emplace_back(value, 1);
        while (runs.size() > 1 && runs[runs.size() - 2].first > runs.back().first) {
            const auto [mean, length] = runs.back();
            runs.pop_back();
            auto& [before, count] = runs.back();
            before = (before * static_cast<double>(count) + mean * static_cast<double>(length)) /
                     static_cast<double>(count + length);
            count += length;
        }
    }
    return runs;
}

Eigen::VectorXd rising_fit(const Eigen::VectorXd& values) {
    Eigen::VectorXd fit(values.size());
    Eigen::Index at = 0;
    for (const auto& [mean, length] : rising_runs(values)) {
        fit.segment(at, length).setConstant(mean);
        at += length;
    }
    return fit;
}

}  // namespace

Signal without_gaps(const Signal& signal) {
    std::vector<double> times, values;
    times.reserve(static_cast<std::size_t>(signal.times.size()));
    values.reserve(static_cast<std::size_t>(signal.times.size()));
    for (Eigen::Index i = 0; i < signal.times.size(); ++i) {
        if (!std::isfinite(signal.values[i]) || !std::isfinite(signal.times[i])) continue;
        times.push_back(signal.times[i]);
        values.push_back(signal.values[i]);
    }
    return {Eigen::Map<Eigen::VectorXd>(times.data(), std::ssize(times)),
            Eigen::Map<Eigen::VectorXd>(values.data(), std::ssize(values))};
}

double value_at(const Signal& signal, double time) {
    const auto n = signal.times.size();
    if (n == 0 || !(time >= signal.times[0]) || !(time <= signal.times[n - 1]))
        return std::numeric_limits<double>::quiet_NaN();
    const double* begin = signal.times.data();
    const Eigen::Index after = std::lower_bound(begin, begin + n, time) - begin;
    if (after == 0) return signal.values[0];
    const double t0 = signal.times[after - 1], t1 = signal.times[after];
    const double share = t1 > t0 ? (time - t0) / (t1 - t0) : 1;
    return (1 - share) * signal.values[after - 1] + share * signal.values[after];
}

double noise_of(const Eigen::VectorXd& values) {
    std::vector<double> steps;
    double before = std::numeric_limits<double>::quiet_NaN(), smallest = 0;
    for (const double value : values) {
        if (!std::isfinite(value)) continue;
        const double step = std::abs(value - before);
        if (std::isfinite(step)) steps.push_back(step);
        if (step > 0 && (smallest == 0 || step < smallest)) smallest = step;
        before = value;
    }
    constexpr double expected = 0.6745 * 1.4142135623730951;
    return std::max(median(std::move(steps)) / expected, smallest / std::sqrt(12.0));
}

double interval_of(const Eigen::VectorXd& times) {
    std::vector<double> steps;
    steps.reserve(static_cast<std::size_t>(times.size()));
    for (Eigen::Index i = 1; i < times.size(); ++i) steps.push_back(times[i] - times[i - 1]);
    return median(std::move(steps));
}

Signal smoothed(const Signal& signal, double width) {
    Signal smooth = signal;
    const auto n = signal.times.size();
    Eigen::Index from = 0, to = 0;
    double sum = 0;
    for (Eigen::Index i = 0; i < n; ++i) {
        while (to < n && signal.times[to] <= signal.times[i] + width / 2) sum += signal.values[to++];
        while (signal.times[from] < signal.times[i] - width / 2) sum -= signal.values[from++];
        smooth.values[i] = sum / static_cast<double>(to - from);
    }
    return smooth;
}

Signal monotone(const Signal& signal) {
    const Eigen::VectorXd up = rising_fit(signal.values);
    const Eigen::VectorXd down = -rising_fit(-signal.values);
    const bool rises = (up - signal.values).squaredNorm() <= (down - signal.values).squaredNorm();
    return {signal.times, rises ? up : down};
}

}  // namespace palpate::identify
