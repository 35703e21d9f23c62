#include "identify/diagnosis/statistics/exchanged_markers.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <set>

namespace palpate::identify {
namespace {

/// A reading of three coordinates.
struct WholeReading {
    int marker = 0, reading = 0;
    Vec3 error, at, sigma;  // in sigmas; [mm]
};

/// Readings of three coordinates, by state.
std::map<int, std::vector<WholeReading>> whole_readings(const Problem& problem, const Eigen::VectorXd& residual) {
    std::map<int, std::vector<WholeReading>> states;
    for (Eigen::Index n = 0; n + 2 < problem.rows(); ++n) {
        if (problem.reading[n] != problem.reading[n + 2]) continue;
        states[problem.state[n]].push_back({problem.coordinate[n] / 3, problem.reading[n], residual.segment<3>(n),
                                            problem.measured.segment<3>(n), problem.sigma.segment<3>(n)});
    }
    return states;
}

/// The error of reading `one` if the other's position were its own [sigmas].
Vec3 error_with_label_of(const WholeReading& one, const WholeReading& other) {
    return one.error + (other.at - one.at).cwiseQuotient(one.sigma);
}

/// Length of an error that is no more than the other readings of a state have, those of a pair apart [sigmas].
double ordinary_error(const std::vector<WholeReading>& state, std::size_t one, std::size_t other) {
    constexpr double rough = 5;           // times the median, as an outlier's
    constexpr double chi_median = 1.538;  // of three normal numbers
    std::vector<double> lengths;
    lengths.reserve(state.size());
    for (std::size_t i = 0; i < state.size(); ++i) {
        if (i != one && i != other) lengths.push_back(state[i].error.norm());
    }
    if (lengths.empty()) return rough * chi_median;
    const auto middle = lengths.begin() + std::ssize(lengths) / 2;
    std::ranges::nth_element(lengths, middle);
    return rough * std::max(*middle, chi_median);
}

}  // namespace

std::vector<ExchangedMarkers> find_exchanged_markers(const Problem& problem, const Eigen::VectorXd& residual) {
    const auto states = whole_readings(problem, residual);
    double pairs = 1;
    for (const auto& [number, state] : states) pairs += 0.5 * static_cast<double>(state.size() * (state.size() - 1));
    constexpr double false_alarms = 1e-6;  // expected in a set; labels are exchanged rarely
    const double least = std::log(pairs / false_alarms);
    std::vector<ExchangedMarkers> likely;
    for (const auto& [number, state] : states) {
        for (std::size_t i = 0; i < state.size(); ++i) {
            for (std::size_t j = i + 1; j < state.size(); ++j) {
                const Vec3 first = error_with_label_of(state[i], state[j]);
                const Vec3 second = error_with_label_of(state[j], state[i]);
                const double told = state[i].error.squaredNorm() + state[j].error.squaredNorm();
                const double ratio = 0.5 * (told - first.squaredNorm() - second.squaredNorm());
                if (ratio < least) continue;
                const double most = ordinary_error(state, i, j);
                if (first.norm() > most || second.norm() > most) continue;
                likely.push_back(
                    {number, {state[i].marker, state[j].marker}, {state[i].reading, state[j].reading}, ratio});
            }
        }
    }
    std::ranges::stable_sort(likely, std::greater{}, &ExchangedMarkers::log_likelihood_ratio);
    std::vector<ExchangedMarkers> result;
    std::set<int> taken;
    for (const ExchangedMarkers& one : likely) {
        if (taken.contains(one.readings.first) || taken.contains(one.readings.second)) continue;
        taken.insert({one.readings.first, one.readings.second});
        result.push_back(one);
    }
    return result;
}

}  // namespace palpate::identify
