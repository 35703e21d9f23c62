// Of a position domain: the sigma of each reading, from its noise and the model error, and that error's estimate.

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "identify/inference/domains/position/position_domain.h"
#include "identify/numerics/summaries.h"
#include "mesh/numbers/median.h"

namespace palpate::identify {
namespace {

using Eigen::numext::abs2;

constexpr double readings_per_state = 6;  // that a state's coordinates count as, of the model error
constexpr double noise_sd = 3;            // of chi^2, up to which what is left is noise

}  // namespace

int PositionDomain::coordinates() const {
    return std::accumulate(states_.begin(), states_.end(), 0,
                           [](int sum, const StateReadings& state) { return sum + state.coordinates; });
}

int PositionDomain::effective_coordinates() const {
    return std::accumulate(states_.begin(), states_.end(), 0, [](int sum, const StateReadings& state) {
        return sum + std::min(state.coordinates, static_cast<int>(readings_per_state));
    });
}

double PositionDomain::squared_scale(int s) const { return abs2(states_[s].displacement) + abs2(least_displacement()); }

double PositionDomain::squared_noise(int s) const {
    const Eigen::VectorXd& noise = states_[s].noise;
    return noise.unaryExpr([](double sigma) { return known_part(sigma); }).squaredNorm() /
           static_cast<double>(noise.size());
}

void PositionDomain::set_model_error(double rel) {
    weights_.clear();
    log_constant_ = 0;
    for (int s = 0; s < static_cast<int>(states_.size()); ++s) {
        const StateReadings& state = states_[s];
        const double share = std::max(1.0, state.coordinates / readings_per_state);
        const double model_variance = share * abs2(rel) * squared_scale(s);
        Eigen::VectorXd weights = Eigen::VectorXd::Zero(3 * state.rest.rows());
        for (Eigen::Index i = 0; i < state.rest.rows(); ++i) {
            const double variance = abs2(known_part(state.noise[i])) + model_variance;
            for (int c = 0; c < 3; ++c) {
                if (std::isnan(state.measured(i, c))) continue;
                weights[3 * i + c] = 1 / variance;
                log_constant_ -= 0.5 * std::log(2 * std::numbers::pi * variance);
            }
        }
        weights_.push_back(std::move(weights));
    }
}

double PositionDomain::estimate_model_error(const Prediction& prediction) const {
    // rel^2 of each state; the median of a mean of six squares lies at 0.89 of its expectation
    std::vector<double> squares;
    double chi_squared = 0;  // of the noise alone
    for (int s = 0; s < static_cast<int>(states_.size()); ++s) {
        const StateReadings& state = states_[s];
        const double noise = squared_noise(s);
        const double left = errors(s, prediction.markers[s]).squaredNorm() / state.coordinates;
        chi_squared += state.coordinates * left / noise;
        squares.push_back(std::max(0.0, left - noise) / squared_scale(s));
    }
    if (chi_squared < coordinates() + noise_sd * std::sqrt(2.0 * coordinates())) return 0;
    return std::sqrt(mesh::upper_median(squares) / 0.89);
}

}  // namespace palpate::identify
