#include "identify/population/population.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numeric>

namespace palpate::identify {
namespace {

constexpr int mean_steps = 41, spread_steps = 81;  // of the grid: 0.3 deviations, and a sixth of an octave or so
constexpr Eigen::Index most_parts = 128;           // of a mixture
constexpr double surely_wide = 1e100;              // a prior that tells nothing

double log_normal_density(double x, double mean, double variance) {
    return -0.5 * (std::log(2 * M_PI * variance) + (x - mean) * (x - mean) / variance);
}

double normal_cdf(double z) { return 0.5 * std::erfc(-z / std::sqrt(2.0)); }

/// One normal part of what a specimen's readings tell, its prior taken off: exp(weight) N(x; mean, variance).
struct Part {
    double mean, variance, log_weight;
};

/// Draws, some perhaps several times, that are all worth the same and lie evenly within the distribution.
/// [systematic resampling of sorted draws: Kitagawa 1996]
std::vector<Eigen::Index> evenly(const Eigen::VectorXd& draws, const Eigen::VectorXd& weights) {
    std::vector<Eigen::Index> order(static_cast<std::size_t>(draws.size())), chosen;
    std::iota(order.begin(), order.end(), 0);
    std::ranges::sort(order, {}, [&](Eigen::Index j) { return draws[j]; });
    const Eigen::Index count = std::min(weights.size(), most_parts);
    chosen.reserve(static_cast<std::size_t>(count));
    double sum = 0;
    for (const Eigen::Index j : order) {
        sum += weights[j];
        while (std::ssize(chosen) < count &&
               sum * static_cast<double>(count) > static_cast<double>(chosen.size()) + 0.5)
            chosen.push_back(j);
    }
    return chosen;
}

/// A specimen's likelihood as a mixture.
class Likelihood {
public:
    explicit Likelihood(const SpecimenNumber& own) {
        const double mean = own.weights.dot(own.draws);
        const bool is_normal = own.draws.size() == 1;
        const std::vector<Eigen::Index> chosen =
            is_normal ? std::vector<Eigen::Index>{0} : evenly(own.draws, own.weights);
        // The bandwidth that is best for a normal density. [Silverman 1986]
        const auto count = static_cast<double>(chosen.size());
        const double h = is_normal ? own.sd : 1.06 * own.sd * std::pow(count, -0.2);
        const double kept = is_normal ? 1 : std::sqrt(1 - h * h / (own.sd * own.sd));
        parts_.reserve(chosen.size());
        for (const Eigen::Index j : chosen) {
            const double x = mean + kept * (own.draws[j] - mean);
            parts_.push_back(without_prior({x, h * h, -std::log(count)}, own));
        }
        for (Part& part : parts_) most_ = std::max(most_, part.log_weight);
        double sum = 0, first = 0, second = 0;
        for (const Part& part : parts_) {
            const double w = std::exp(part.log_weight - most_);
            sum += w;
            first += w * part.mean;
            second += w * (part.variance + part.mean * part.mean);
        }
        mean_ = first / sum;
        sd_ = std::sqrt(second / sum - mean_ * mean_);
    }

    double mean() const { return mean_; }
    double sd() const { return sd_; }
    /// ln L(m, t).
    double log_value(double m, double t) const {
        double sum = 0;
        for (const Part& part : parts_)
            sum += std::exp(part.log_weight - most_ + log_normal_density(part.mean, m, part.variance + t * t));
        return most_ + std::log(sum);
    }
    struct Moments {
        double mean, square;
    };
    /// Of x, given m and t.
    Moments moments(double m, double t) const {
        double sum = 0, first = 0, second = 0;
        for (const Part& part : parts_) {
            const double w =
                std::exp(part.log_weight - most_ + log_normal_density(part.mean, m, part.variance + t * t));
            const double share = t * t / (t * t + part.variance);
            const double mean = share * part.mean + (1 - share) * m;
            sum += w;
            first += w * mean;
            second += w * (share * part.variance + mean * mean);
        }
        return {first / sum, second / sum};
    }

private:
    /// N(x; a, v) / N(x; m, s^2) is a normal density times a constant, as v < s^2.
    static Part without_prior(const Part& part, const SpecimenNumber& own) {
        if (own.prior_sd > surely_wide) return part;
        const double s2 = own.prior_sd * own.prior_sd;
        assert(part.variance < s2);
        const double variance = 1 / (1 / part.variance - 1 / s2);
        const double mean = variance * (part.mean / part.variance - own.prior_mean / s2);
        const double log_weight = part.log_weight + log_normal_density(mean, part.mean, part.variance) -
                                  log_normal_density(mean, own.prior_mean, s2) -
                                  log_normal_density(mean, mean, variance);
        return {mean, variance, log_weight};
    }

    std::vector<Part> parts_;
    double most_ = -INFINITY, mean_ = 0, sd_ = 0;
};

/// The population's mean and spread as specimens tell them, on a grid: for each spread the means about the best one.
class Population {
public:
    Population(const std::vector<const Likelihood*>& specimens, double most_spread) {
        // Spreads below a hundredth of what any specimen is known to cannot be told from none.
        double closest = INFINITY;
        for (const Likelihood* one : specimens) closest = std::min(closest, one->sd());
        const double smallest = 0.01 * closest, largest = std::max(4 * most_spread, 2 * smallest);
        for (int j = 0; j < spread_steps; ++j) {
            const double t = smallest * std::pow(largest / smallest, static_cast<double>(j) / (spread_steps - 1));
            double precision = 0, weighted = 0;
            for (const Likelihood* one : specimens) {
                const double own = 1 / (one->sd() * one->sd() + t * t);
                precision += own;
                weighted += own * one->mean();
            }
            const double sd = 1 / std::sqrt(precision);
            // Even in the mean, half-normal in the spread, whose steps grow with it as those of the mean with its sd.
            const double prior = std::log(t * sd) - 0.5 * t * t / (most_spread * most_spread);
            for (int i = 0; i < mean_steps; ++i) {
                const double z = farthest * (2.0 * i / (mean_steps - 1) - 1);
                Node node{weighted / precision + z * sd, t, prior};
                for (const Likelihood* one : specimens) node.weight += one->log_value(node.mean, t);
                nodes_.push_back(node);
            }
        }
        double most = -INFINITY, sum = 0;
        for (const Node& node : nodes_) most = std::max(most, node.weight);
        for (Node& node : nodes_) sum += node.weight = std::exp(node.weight - most);
        for (Node& node : nodes_) node.weight /= sum;
    }

    template <class F>
    double expectation(const F& f) const {
        double sum = 0;
        for (const Node& node : nodes_)
            if (node.weight > negligible) sum += node.weight * f(node.mean, node.spread);
        return sum;
    }
    /// Where the spread's distribution reaches a share.
    double spread_quantile(double share) const {
        double sum = 0, before = 0;
        for (const Node& node : nodes_) {
            sum += node.weight;
            if (sum >= share) return std::sqrt(node.spread * std::max(before, node.spread / spread_step()));
            before = node.spread;
        }
        return nodes_.back().spread;
    }

private:
    struct Node {
        double mean, spread, weight;
    };
    static constexpr double farthest = 6;        // deviations
    static constexpr double negligible = 1e-12;  // of all weight
    double spread_step() const { return nodes_[mean_steps].spread / nodes_[0].spread; }

    std::vector<Node> nodes_;  // by spread, then by mean
};

}  // namespace

PooledNumber pool(const std::vector<SpecimenNumber>& specimens, double most_spread) {
    assert(specimens.size() > 1);
    std::vector<Likelihood> likelihoods;
    likelihoods.reserve(specimens.size());
    for (const SpecimenNumber& own : specimens) likelihoods.emplace_back(own);
    std::vector<const Likelihood*> all;
    all.reserve(likelihoods.size());
    for (const Likelihood& one : likelihoods) all.push_back(&one);
    const Population population(all, most_spread);

    PooledNumber result;
    const auto squared = [](double x) { return x * x; };
    result.mean = population.expectation([](double m, double) { return m; });
    result.mean_sd = std::sqrt(population.expectation([&](double m, double) { return squared(m - result.mean); }));
    result.spread = population.spread_quantile(0.5);
    result.spread_low = population.spread_quantile(0.025);
    result.spread_high = population.spread_quantile(0.975);
    result.next_mean = result.mean;
    result.next_sd =
        std::hypot(result.mean_sd, std::sqrt(population.expectation([](double, double t) { return t * t; })));
    for (std::size_t s = 0; s < specimens.size(); ++s) {
        const Likelihood& own = likelihoods[s];
        PooledSpecimen pooled{.specimen = specimens[s].specimen, .own_mean = own.mean(), .own_sd = own.sd()};
        pooled.mean = population.expectation([&](double m, double t) { return own.moments(m, t).mean; });
        const double square = population.expectation([&](double m, double t) { return own.moments(m, t).square; });
        pooled.sd = std::sqrt(std::max(0.0, square - squared(pooled.mean)));
        std::vector<const Likelihood*> others = all;
        others.erase(others.begin() + static_cast<std::ptrdiff_t>(s));
        const double below = Population(others, most_spread).expectation([&](double m, double t) {
            return normal_cdf((own.mean() - m) / std::hypot(t, own.sd()));
        });
        pooled.p_value = 2 * std::min(below, 1 - below);
        constexpr double false_alarms = 0.05;  // populations in which chance alone names a specimen
        pooled.is_outlying = pooled.p_value < false_alarms / static_cast<double>(specimens.size());
        result.specimens.push_back(std::move(pooled));
    }
    return result;
}

}  // namespace palpate::identify
