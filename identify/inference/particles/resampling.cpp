#include "identify/inference/particles/resampling.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "mesh/errors.h"

namespace palpate::identify {

double normalise(Eigen::VectorXd& log_weights) {
    const double largest = log_weights.maxCoeff();
    if (!std::isfinite(largest)) {
        throw SolverFailure("no particle has a weight: none of the tried stiffnesses explains the measurements");
    }
    const double log_sum = largest + std::log((log_weights.array() - largest).exp().sum());
    log_weights.array() -= log_sum;
    return log_sum;
}

double effective_samples(const Eigen::VectorXd& log_weights) { return 1 / (2 * log_weights.array()).exp().sum(); }

std::vector<int> low_variance_resample(const Eigen::VectorXd& log_weights, int count, double u) {
    const Eigen::VectorXd weights = log_weights.array().exp();
    std::vector<int> chosen;
    chosen.reserve(count);
    const int last = static_cast<int>(weights.size()) - 1;
    int i = 0;
    double cumulated = weights[0];
    for (int tooth = 0; tooth < count; ++tooth) {
        while (cumulated < (tooth + u) / count && i < last) cumulated += weights[++i];
        chosen.push_back(i);
    }
    return chosen;
}

Eigen::VectorXd reweighted(const Eigen::VectorXd& log_weights, const Eigen::VectorXd& log_ratio, double db) {
    return log_weights + db * log_ratio;
}

double temperature_step(const Eigen::VectorXd& log_weights, const Eigen::VectorXd& log_ratio, double b, double wanted) {
    const auto effective = [&](double db) {
        Eigen::VectorXd trial = reweighted(log_weights, log_ratio, db);
        normalise(trial);
        return effective_samples(trial);
    };
    if (effective(1 - b) >= wanted) return 1 - b;
    double low = 0, high = 1 - b;
    for (int i = 0; i < 60 && high - low > 1e-3 * high; ++i) {
        const double middle = (low + high) / 2;
        (effective(middle) >= wanted ? low : high) = middle;
    }
    return high;  // particles without density go with the first step
}

double weighted_quantile(const Eigen::VectorXd& values, const Eigen::VectorXd& weights, double q) {
    std::vector<int> order(values.size());
    std::iota(order.begin(), order.end(), 0);
    std::ranges::sort(order, {}, [&](int i) { return values[i]; });

    // each value stands in the middle of its weight; linear in between
    double cumulated = 0, previous_value = values[order.front()], previous_middle = 0;
    for (const int i : order) {
        const double middle = cumulated + weights[i] / 2;
        if (q <= middle) {
            const double gap = middle - previous_middle;
            const double t = gap > 0 ? (q - previous_middle) / gap : 1;
            return previous_value + t * (values[i] - previous_value);
        }
        cumulated += weights[i];
        previous_value = values[i];
        previous_middle = middle;
    }
    return values[order.back()];
}

}  // namespace palpate::identify
