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

/// Length of an error that is no more than others of a state have [sigmas].
double ordinary_error(const std::vector<WholeReading>& state) {
    constexpr double rough = 5;           // times the median, as an outlier's
    constexpr double chi_median = 1.538;  // of three normal numbers
    std::vector<double> lengths;
    lengths.reserve(state.size());
    for (const WholeReading& reading : state) lengths.push_back(reading.error.norm());
    const auto middle = lengths.begin() + std::ssize(lengths) / 2;
    std::ranges::nth_element(lengths, middle);
    return rough * std::max(*middle, chi_median);
}

}  // namespace

std::vector<ExchangedMarkers> find_exchanged_markers(const Problem& problem, const Eigen::VectorXd& residual) {
    std::vector<ExchangedMarkers> likely;
    double pairs = 0;
    for (const auto& [number, state] : whole_readings(problem, residual)) {
        const double most = ordinary_error(state);
        for (std::size_t i = 0; i < state.size(); ++i) {
            for (std::size_t j = i + 1; j < state.size(); ++j) {
                ++pairs;
                const Vec3 first = error_with_label_of(state[i], state[j]);
                const Vec3 second = error_with_label_of(state[j], state[i]);
                if (first.norm() > most || second.norm() > most) continue;
                const double told = state[i].error.squaredNorm() + state[j].error.squaredNorm();
                const double ratio = 0.5 * (told - first.squaredNorm() - second.squaredNorm());
                likely.push_back(
                    {number, {state[i].marker, state[j].marker}, {state[i].reading, state[j].reading}, ratio});
            }
        }
    }
    std::ranges::stable_sort(likely, std::greater{}, &ExchangedMarkers::log_likelihood_ratio);
    constexpr double false_alarms = 1e-6;  // expected in a set; labels are exchanged rarely
    const double least = std::log(std::max(pairs, 1.0) / false_alarms);
    std::vector<ExchangedMarkers> result;
    std::set<int> taken;
    for (const ExchangedMarkers& one : likely) {
        if (one.log_likelihood_ratio < least) break;
        if (taken.contains(one.readings.first) || taken.contains(one.readings.second)) continue;
        taken.insert({one.readings.first, one.readings.second});
        result.push_back(one);
    }
    return result;
}

}  // namespace palpate::identify
