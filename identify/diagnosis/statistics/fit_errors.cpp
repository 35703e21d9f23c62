#include "identify/diagnosis/statistics/fit_errors.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "identify/comparison/load_exponent.h"

namespace palpate::identify {
namespace {

/// Of the positions [mm^2].
double mean_square(const Problem& problem, const Eigen::VectorXd& v) {
    const double rms = problem.rms_mm(v);
    return rms * rms;
}

/// Values of the positions as marker coordinates of each state (m x 3); NaN: not measured.
std::vector<Points> by_state(const Problem& problem, const Eigen::VectorXd& values) {
    const int states = problem.state.empty() ? 0 : *std::ranges::max_element(problem.state) + 1;
    std::vector<Points> result(states, Points::Constant(problem.markers, 3, missing));
    for (Eigen::Index n = 0; n < problem.rows(); ++n) {
        if (problem.is_position(n)) result[problem.state[n]](problem.channel(n), problem.coordinate[n] % 3) = values[n];
    }
    return result;
}

/// Length of the longest error vector of a reading.
double longest(const Problem& problem, const Eigen::VectorXd& error) {
    Eigen::VectorXd squares = Eigen::VectorXd::Zero(problem.readings());
    for (Eigen::Index n = 0; n < problem.rows(); ++n)
        if (problem.is_position(n)) squares[problem.reading[n]] += error[n] * error[n];
    return squares.size() > 0 ? std::sqrt(squares.maxCoeff()) : 0;
}

std::vector<ErrorUnderLoad> under_load(const Problem& problem, const Eigen::VectorXd& error) {
    const Eigen::VectorXd moved = problem.displacement() - error;  // by the model
    struct Sums {
        double load = 0, error = 0, noise = 0;
        int rows = 0;
    };
    std::map<int, Sums> states;
    for (Eigen::Index n = 0; n < problem.rows(); ++n) {
        if (!problem.is_position(n)) continue;
        Sums& sums = states[problem.state[n]];
        sums.load += moved[n] * moved[n];
        sums.error += error[n] * error[n];
        sums.noise += problem.sigma[n] * problem.sigma[n];
        ++sums.rows;
    }
    std::vector<ErrorUnderLoad> result;
    for (const auto& [state, sums] : states) {
        const auto rms = [n = sums.rows](double sum) { return std::sqrt(sum / n); };
        result.push_back({rms(sums.load), rms(sums.error), rms(sums.noise), sums.rows});
    }
    return result;
}

}  // namespace

FitErrors errors_of(const Problem& problem, const Refit& fit) {
    const Eigen::VectorXd error = fit.error.cwiseProduct(problem.sigma);
    const Eigen::VectorXd left = fit.residual.cwiseProduct(problem.sigma);

    FitErrors result;
    result.rms = problem.rms_mm(error);
    result.rms_n = problem.rms_n(error);
    result.max = longest(problem, error);
    result.relative = problem.relative(error);
    result.whitened_rms = fit.whitened_rms;
    result.nuisance_sd = problem.rms_mm(fit.V->nuisance_sd().cwiseProduct(problem.sigma));
    result.left =
        std::max(mean_square(problem, left), mean_square(problem, error) - result.nuisance_sd * result.nuisance_sd);
    result.load_exponent = load_exponent(under_load(problem, error));
    result.where =
        locate_misfit(problem.rest.topRows(problem.markers), by_state(problem, left), by_state(problem, fit.residual));
    return result;
}

double mean_square_error(const Problem& problem, const MeasurementSet& set, const Comparison& comparison) {
    const std::vector<Points> counts = by_state(problem, Eigen::VectorXd::Ones(problem.rows()));
    double sum = 0;
    int coordinates = 0;
    for (std::size_t s = 0; s < counts.size(); ++s) {
        for (std::size_t r = 0; r < set.states[s].readings.size(); ++r) {
            const Reading& reading = set.states[s].readings[r];
            if (reading.marker < 0) continue;
            const Vec3 error = reading.position - comparison.predicted[s].row(static_cast<Eigen::Index>(r)).transpose();
            for (int axis = 0; axis < 3; ++axis) {
                if (std::isnan(counts[s](reading.marker, axis)) || std::isnan(error[axis])) continue;
                sum += error[axis] * error[axis];
                ++coordinates;
            }
        }
    }
    return coordinates > 0 ? sum / coordinates : 0;
}

}  // namespace palpate::identify
