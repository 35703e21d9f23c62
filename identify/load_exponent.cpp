#include "identify/load_exponent.h"

#include <algorithm>
#include <cmath>

namespace palpate::identify {
namespace {

constexpr double unknown_noise_floor = 0.02;  // of the typical error, where the noise is unknown
constexpr double least_growth = 0.4;          // an exponent below it: the error is there without load
constexpr double least_ratio = 1.2;           // between the largest load and the least, to tell anything

struct LogPoint {
    double load, error;  // natural logarithms
};

double median(std::vector<double> values) {
    std::ranges::sort(values);
    return values[values.size() / 2];
}

double beyond_noise(const ErrorUnderLoad& state, double floor) {
    return std::sqrt(std::max(state.rms * state.rms - state.noise * state.noise, floor * floor));
}

/// Slope and its standard error; with two points there is no scatter to tell it from, and one in the slope is assumed.
LoadExponent fit_line(const std::vector<LogPoint>& points) {
    const auto n = static_cast<double>(points.size());
    double mean_load = 0, mean_error = 0;
    for (const LogPoint& p : points) {
        mean_load += p.load / n;
        mean_error += p.error / n;
    }
    double xx = 0, xy = 0, yy = 0;
    for (const LogPoint& p : points) {
        xx += (p.load - mean_load) * (p.load - mean_load);
        xy += (p.load - mean_load) * (p.error - mean_error);
        yy += (p.error - mean_error) * (p.error - mean_error);
    }
    const double slope = xy / xx;
    const double scatter = std::max(0.0, yy - slope * xy);
    return {slope, n > 2 ? std::sqrt(scatter / ((n - 2) * xx)) : 1.0, {}};
}

const char* words_for(const LoadExponent& exponent) {
    if (exponent.sd > 0.5) return "the loads differ too little to tell how the error grows with them";
    if (exponent.value < least_growth) return "the error is there without any load";
    if (exponent.value < 1.5) return "the error grows in proportion to the load, like a wrong stiffness";
    return "the error grows faster than the load, like a nonlinearity";
}

}  // namespace

std::optional<LoadExponent> load_exponent(const std::vector<ErrorUnderLoad>& states) {
    std::vector<ErrorUnderLoad> loaded, unloaded;
    for (const ErrorUnderLoad& state : states) (state.load > 0 ? loaded : unloaded).push_back(state);
    if (loaded.empty()) return std::nullopt;

    // what counts as no error: noise at a tenth, for it was taken off in squares
    std::vector<double> errors, loads;
    for (const ErrorUnderLoad& state : loaded) {
        errors.push_back(state.rms);
        loads.push_back(state.load);
    }
    const double typical_error = median(errors), typical_load = median(loads);
    const double noise = median([&] {
        std::vector<double> all;
        for (const ErrorUnderLoad& state : states) all.push_back(state.noise);
        return all;
    }());
    const double floor = noise > 0 ? noise / 10 : unknown_noise_floor * typical_error;
    if (typical_error <= floor) return std::nullopt;

    std::vector<LogPoint> points;
    for (const ErrorUnderLoad& state : loaded) {
        points.push_back({std::log(state.load), std::log(beyond_noise(state, floor))});
    }
    const auto [least, most] = std::ranges::minmax(loads);
    const bool levels = most >= least_ratio * least;

    // states without load, at the load at which an error in proportion to it would sink into the floor
    const double sinking_load = typical_load * floor / typical_error;
    std::vector<LogPoint> silent;  // without load and without error
    for (const ErrorUnderLoad& state : unloaded) {
        const double error = beyond_noise(state, floor);
        (error > 3 * floor ? points : silent).push_back({std::log(sinking_load), std::log(error)});
    }
    if (!levels && unloaded.empty()) return std::nullopt;

    // an error that vanishes with the load is not there without it, however the loaded states scatter
    if (!levels || (!silent.empty() && fit_line(points).value < least_growth)) {
        points.insert(points.end(), silent.begin(), silent.end());
    }
    LoadExponent exponent = fit_line(points);
    exponent.words = words_for(exponent);
    return exponent;
}

}  // namespace palpate::identify
