#include "identify/diagnosis/statistics/outliers/outliers.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>
#include <utility>

#include "identify/numerics/summaries.h"
#include "mesh/numbers/median.h"

namespace palpate::identify {
namespace {

constexpr int neighbours = 6;  // an even number, whose median lies between two; fewer are noisier, more reach farther
constexpr int least_readings = 8;   // of a state: with fewer, six neighbours are all of it
constexpr double most_share = 0.1;  // of the readings; more are no matter of single ones

struct ReadingError {
    int marker = 0, state = 0;
    Vec3 error = Vec3::Zero();
    int coordinates = 0;
};

std::vector<ReadingError> by_reading(const Problem& problem, const Eigen::VectorXd& residual) {
    std::vector<ReadingError> result(problem.readings());
    for (Eigen::Index n = 0; n < problem.rows(); ++n) {
        if (!problem.is_position(n)) continue;
        ReadingError& reading = result[problem.reading[n]];
        reading.marker = problem.channel(n);
        reading.state = problem.state[n];
        reading.error[problem.coordinate[n] % 3] = residual[n];
        ++reading.coordinates;
    }
    return result;
}

/// Median of the neighbours' errors, coordinate by coordinate.
Vec3 median_of_neighbours(const Problem& problem, const std::vector<ReadingError>& all, const std::vector<int>& state,
                          int reading) {
    std::vector<std::pair<double, int>> near;
    near.reserve(state.size());
    for (const int other : state) {
        if (other == reading) continue;
        near.emplace_back((problem.rest.row(all[other].marker) - problem.rest.row(all[reading].marker)).squaredNorm(),
                          other);
    }
    std::ranges::partial_sort(near, near.begin() + neighbours);
    Vec3 result;
    for (int axis = 0; axis < 3; ++axis) {
        std::array<double, neighbours> values{};
        for (int i = 0; i < neighbours; ++i) values[i] = all[near[i].second].error[axis];
        std::ranges::sort(values);
        result[axis] = 0.5 * (values[neighbours / 2 - 1] + values[neighbours / 2]);
    }
    return result;
}

/// Scale of the roughness that noise of 1 has: the median of n is itself noisy, with a variance of about pi / (2 n).
double noise_roughness() { return std::sqrt(1 + M_PI / (2 * neighbours)); }

}  // namespace

Roughness roughness(const Problem& problem, const Eigen::VectorXd& residual) {
    const std::vector<ReadingError> all = by_reading(problem, residual);
    std::map<int, std::vector<int>> states;
    for (std::size_t i = 0; i < all.size(); ++i)
        if (all[i].coordinates > 0) states[all[i].state].push_back(static_cast<int>(i));

    Roughness result;
    std::vector<double> scaled;
    for (std::size_t i = 0; i < all.size(); ++i) {
        if (all[i].coordinates == 0) {  // of a tool
            result.size.push_back(0);
            continue;
        }
        const std::vector<int>& state = states[all[i].state];
        Vec3 error = all[i].error;
        if (std::ssize(state) >= least_readings && all[i].coordinates == 3) {
            error -= median_of_neighbours(problem, all, state, static_cast<int>(i));
        }
        result.size.push_back(error.norm());
        scaled.push_back(error.norm() / chi_median[all[i].coordinates]);
    }
    if (!scaled.empty()) result.scale = mesh::upper_median(std::move(scaled));
    return result;
}

double noise_by_roughness(const Problem& problem, const Eigen::VectorXd& error_mm) {
    return roughness(problem, error_mm).scale / noise_roughness();
}

Outliers find_outliers(const Problem& problem, const Eigen::VectorXd& residual,
                       std::vector<ExchangedMarkers> exchanged_ones) {
    const Roughness rough_ones = roughness(problem, residual);
    const double scale = std::max(rough_ones.scale, noise_roughness());
    Outliers result;
    result.exchanged = std::move(exchanged_ones);
    std::set<int> exchanged;
    for (const ExchangedMarkers& one : result.exchanged) {
        exchanged.insert({one.readings.first, one.readings.second});
        result.log_bayes_factor += one.log_likelihood_ratio;
    }
    std::vector<double> squares;
    std::vector<int> single;
    for (int i = 0; i < static_cast<int>(rough_ones.size.size()); ++i) {
        if (exchanged.contains(i)) continue;
        squares.push_back(std::pow(rough_ones.size[i] / scale, 2));
        if (squares.back() > rough_reading * rough_reading) single.push_back(i);
    }
    if (static_cast<double>(single.size()) > most_share * static_cast<double>(squares.size())) single.clear();
    if (single.empty() && exchanged.empty()) return {};
    result.readings = single;
    result.readings.insert(result.readings.end(), exchanged.begin(), exchanged.end());
    std::ranges::sort(result.readings);
    if (single.empty()) {
        const auto count = static_cast<double>(exchanged.size());
        double sum = 0;
        for (const int i : exchanged) sum += std::pow(rough_ones.size[i] / scale, 2);
        result.share = count / static_cast<double>(problem.readings());
        result.width = std::sqrt(sum / (3 * count));
        return result;
    }

    // ln of (1 - eps) N(0, 1) + eps N(0, w^2) over N(0, 1), for vectors of three, summed over the readings; the grid is
    // the prior, about even in the logarithms of share and width
    std::vector<double> logs;
    double best = -INFINITY;
    for (const double share : {0.003, 0.01, 0.03, 0.06, 0.1}) {
        for (const double width : {4., 8., 15., 30., 60.}) {
            double sum = 0;
            for (const double q : squares) {
                const double wide = std::log(share) - 3 * std::log(width) + 0.5 * q * (1 - 1 / (width * width));
                const double narrow = std::log1p(-share);
                sum += std::max(wide, narrow) + std::log1p(std::exp(-std::abs(wide - narrow)));
            }
            logs.push_back(sum);
            if (sum > best) {
                best = sum;
                result.share = share;
                result.width = width;
            }
        }
    }
    result.log_bayes_factor += log_mean_exp(logs);
    return result;
}

std::vector<char> rows_without(const Problem& problem, const std::vector<int>& readings) {
    std::vector<char> keep(problem.rows(), 1);
    for (Eigen::Index n = 0; n < problem.rows(); ++n) {
        keep[n] = !std::ranges::binary_search(readings, problem.reading[n]);
    }
    return keep;
}

}  // namespace palpate::identify
