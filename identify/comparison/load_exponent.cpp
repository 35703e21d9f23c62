#include "identify/comparison/load_exponent.h"

#include <algorithm>
#include <cmath>

#include "mesh/numbers/median.h"

namespace palpate::identify {
namespace {

constexpr double unknown_noise_floor = 0.02;  // of the typical error, where the noise is unknown
constexpr double least_growth = 0.4;          // an exponent below it: the error is there without load
constexpr double rounding = 1e-9;             // a load below this share of the largest is none
constexpr double least_ratio = 1.2;           // between the largest load and the least, to tell anything

struct LogPoint {
    double load, error;  // natural logarithms
};

double beyond_noise(const ErrorUnderLoad& state, double floor) {
    return std::sqrt(std::max(state.rms * state.rms - state.noise * state.noise, floor * floor));
}

/// What may be left of noise that was taken off in squares: two sigma of a mean of so many squares.
double noise_left(const ErrorUnderLoad& state) { return state.noise * std::pow(8.0 / state.coordinates, 0.25); }

template <typename Value>
std::vector<double> collect(const std::vector<ErrorUnderLoad>& states, Value value) {
    std::vector<double> values(states.size());
    std::ranges::transform(states, values.begin(), value);
    return values;
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

/// What the states without load say of the error, which loaded ones alone do not tell.
enum class Unloaded { none_read, moved, without_error, with_error };

const char* words_for(const LoadExponent& exponent, Unloaded unloaded) {
    if (exponent.sd > 0.5) return "the errors scatter too much to tell how they grow with the load";
    if (exponent.value < least_growth && unloaded == Unloaded::none_read)
        return "the errors do not grow with the load; an unloaded state is needed to see whether they exist without "
               "any";
    if (exponent.value < least_growth && unloaded == Unloaded::moved) return "the errors do not grow with the load";
    if (exponent.value < least_growth && unloaded == Unloaded::without_error)
        return "nothing is wrong without load, and from probe to probe the errors do not grow with it: places differ "
               "more than loads";
    if (exponent.value < least_growth) return "the error is there without any load";
    if (exponent.value < 1.5) return "the error grows in proportion to the load, like a wrong stiffness";
    return "the error grows faster than the load, like a nonlinearity";
}

}  // namespace

std::optional<LoadExponent> load_exponent(const std::vector<ErrorUnderLoad>& states) {
    double largest = 0;
    for (const ErrorUnderLoad& state : states) largest = std::max(largest, state.load);
    std::vector<ErrorUnderLoad> loaded, unloaded;
    for (const ErrorUnderLoad& state : states) (state.load > rounding * largest ? loaded : unloaded).push_back(state);
    if (loaded.empty()) return std::nullopt;

    const std::vector<double> loads = collect(loaded, [](const ErrorUnderLoad& state) { return state.load; });
    const double typical_load = mesh::upper_median(loads);
    const double typical_error =
        mesh::upper_median(collect(loaded, [](const ErrorUnderLoad& state) { return state.rms; }));
    const double noise_floor = mesh::upper_median(collect(states, noise_left));
    const double floor = noise_floor > 0 ? noise_floor : unknown_noise_floor * typical_error;
    if (typical_error <= floor) return std::nullopt;

    std::vector<LogPoint> points;
    points.reserve(states.size());
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
        (error > floor ? points : silent).push_back({std::log(sinking_load), std::log(error)});
    }
    if (!levels && unloaded.empty()) return std::nullopt;

    // an error that vanishes with the load is not there without it, however the loaded states scatter
    if (!levels || (!silent.empty() && fit_line(points).value < least_growth)) {
        points.insert(points.end(), silent.begin(), silent.end());
    }
    LoadExponent exponent = fit_line(points);
    const bool is_read = std::ranges::any_of(states, [](const ErrorUnderLoad& state) { return !state.loaded; });
    exponent.words = words_for(exponent, unloaded.empty() ? (is_read ? Unloaded::moved : Unloaded::none_read)
                                         : silent.size() == unloaded.size() ? Unloaded::without_error
                                                                            : Unloaded::with_error);
    return exponent;
}

}  // namespace palpate::identify
