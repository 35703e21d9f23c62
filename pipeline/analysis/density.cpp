#include "pipeline/analysis/density.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "identify/inference/particles/resampling.h"

namespace palpate::pipeline {
namespace {

constexpr int grid_points = 121;        // points of a density
constexpr double within_kernel = 5;     // sd, beyond which a particle adds nothing
constexpr double most_of_normal = 2.5;  // sd that hold nearly all of it
constexpr double least_spread = 1e-3;   // of ln x: particles that agree are drawn so wide

double gaussian(double x) { return std::exp(-x * x / 2) / std::sqrt(2 * std::numbers::pi); }

/// A prior by ln x. Log-normal with the row's mean and sd, or even in x between mean -+ sqrt(3) sd.
class LogPrior {
public:
    LogPrior(const identify::PosteriorRow& row, PriorKind kind) : kind_(kind) {
        if (kind == PriorKind::even) {
            middle_ = std::log(row.prior_mean);
            reach_ = std::sqrt(3.0) * row.prior_sd / row.prior_mean;
        } else {
            const double variance = std::log1p(std::pow(row.prior_sd / row.prior_mean, 2));
            middle_ = std::log(row.prior_mean) - variance / 2;
            reach_ = std::sqrt(variance);
        }
    }
    double middle() const { return middle_; }
    double low() const { return kind_ == PriorKind::even ? std::log1p(-std::min(reach_, 0.99)) : -span(); }
    double high() const { return kind_ == PriorKind::even ? std::log1p(reach_) : span(); }
    /// By t = ln x - middle. Even in x it is x by ln x.
    double operator()(double t) const {
        if (kind_ == PriorKind::log_normal) return gaussian(t / reach_) / reach_;
        return std::abs(std::expm1(t)) <= reach_ ? std::exp(t) / (2 * reach_) : 0;
    }

private:
    double span() const { return most_of_normal * reach_; }
    PriorKind kind_;
    double middle_ = 0, reach_ = 1;  // reach: sd of ln x, or half the box over its middle
};

/// Weighted values of one quantity, as logarithms over the prior's middle.
struct Sample {
    Eigen::VectorXd t, weights;
    double bandwidth = 0;
    double low = 0, middle = 0, high = 0;  // 2.5 %, median, 97.5 %
};

Sample sample_of(const ParticleSet& particles, Eigen::Index column, double prior_middle) {
    Sample sample{particles.stiffness.col(column).array().log() - prior_middle, particles.weights};
    sample.low = identify::weighted_quantile(sample.t, sample.weights, 0.025);
    sample.middle = identify::weighted_quantile(sample.t, sample.weights, 0.5);
    sample.high = identify::weighted_quantile(sample.t, sample.weights, 0.975);
    const double mean = sample.weights.dot(sample.t);
    const double sd = std::sqrt(sample.weights.dot((sample.t.array() - mean).square().matrix()));
    const double quartiles = identify::weighted_quantile(sample.t, sample.weights, 0.75) -
                             identify::weighted_quantile(sample.t, sample.weights, 0.25);
    const double spread = quartiles > 0 ? std::min(sd, quartiles / 1.34) : sd;
    const double count = 1 / sample.weights.squaredNorm();  // effective
    sample.bandwidth = std::max(least_spread, 0.9 * spread * std::pow(count, -0.2));
    return sample;
}

/// Of each sample the same share.
double smoothed(const std::vector<Sample>& samples, double t) {
    double sum = 0;
    for (const Sample& sample : samples) {
        for (Eigen::Index i = 0; i < sample.t.size(); ++i) {
            const double away = (t - sample.t[i]) / sample.bandwidth;
            if (std::abs(away) < within_kernel) sum += sample.weights[i] * gaussian(away) / sample.bandwidth;
        }
    }
    return sum / static_cast<double>(samples.size());
}

double at_prior(const std::vector<LogPrior>& priors, double t) {
    const double sum = std::accumulate(priors.begin(), priors.end(), 0.0,
                                       [&](double before, const LogPrior& prior) { return before + prior(t); });
    return sum / static_cast<double>(priors.size());
}

/// What an axis holds, by t.
std::pair<double, double> axis_of(const std::vector<LogPrior>& priors, const std::vector<Sample>& samples) {
    double low = samples.front().low, high = samples.front().high;
    double prior_low = priors.front().low(), prior_high = priors.front().high();
    for (const Sample& sample : samples) {
        low = std::min(low, sample.low - 2 * sample.bandwidth);
        high = std::max(high, sample.high + 2 * sample.bandwidth);
    }
    for (const LogPrior& prior : priors) {
        prior_low = std::min(prior_low, prior.low());
        prior_high = std::max(prior_high, prior.high());
    }
    const double reach = high - low;
    return {std::min(low, std::max(prior_low, low - reach)), std::max(high, std::min(prior_high, high + reach))};
}

void draw_over(double shift, const std::vector<LogPrior>& priors, const std::vector<Sample>& samples,
               KnownBeforeAndAfter& known) {
    const auto [low, high] = axis_of(priors, samples);
    for (int i = 0; i < grid_points; ++i) {
        const double t = low + (high - low) * i / (grid_points - 1);
        known.prior.emplace_back(t + shift, at_prior(priors, t));
        known.posterior.emplace_back(t + shift, smoothed(samples, t));
    }
}

}  // namespace

KnownBeforeAndAfter density_of(const identify::PosteriorRow& row, const ParticleSet& particles, Eigen::Index column,
                               PriorKind prior) {
    const LogPrior before(row, prior);
    const Sample after = sample_of(particles, column, before.middle());
    KnownBeforeAndAfter known{.name = row.parameter, .unit = row.unit, .prior = {}, .posterior = {}};
    known.low = std::exp(after.low + before.middle());
    known.middle = std::exp(after.middle + before.middle());
    known.high = std::exp(after.high + before.middle());
    draw_over(before.middle(), {before}, {after}, known);
    return known;
}

KnownBeforeAndAfter pooled_density(const std::string& kind, const std::vector<identify::PosteriorRow>& rows,
                                   const ParticleSet& particles, const std::vector<Eigen::Index>& columns,
                                   PriorKind prior) {
    std::vector<LogPrior> before;
    std::vector<Sample> after;
    Eigen::VectorXd middles(static_cast<Eigen::Index>(columns.size()));
    for (std::size_t i = 0; i < columns.size(); ++i) {
        before.emplace_back(rows[static_cast<std::size_t>(columns[i])], prior);
        after.push_back(sample_of(particles, columns[i], before.back().middle()));
        middles[static_cast<Eigen::Index>(i)] = after.back().middle;
    }
    const Eigen::VectorXd alike = Eigen::VectorXd::Constant(middles.size(), 1.0 / static_cast<double>(middles.size()));
    KnownBeforeAndAfter known{.name = kind, .unit = "", .prior = {}, .posterior = {}};
    known.low = std::exp(identify::weighted_quantile(middles, alike, 0.025));
    known.middle = std::exp(identify::weighted_quantile(middles, alike, 0.5));
    known.high = std::exp(identify::weighted_quantile(middles, alike, 0.975));
    draw_over(0, before, after, known);
    return known;
}

}  // namespace palpate::pipeline
