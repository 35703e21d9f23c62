#include "identify/tempered_filter.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "identify/parallel.h"
#include "identify/random.h"
#include "identify/resampling.h"
#include "mesh/errors.h"

namespace palpate::identify {
namespace {

/// The cloud in whitened coordinates, a column per particle.
struct Cloud {
    Eigen::MatrixXd z;          // (P x N)
    Eigen::VectorXd log_ratio;  // ln pi - ln q of each (N)

    int size() const { return static_cast<int>(z.cols()); }
};

class Filter {
public:
    Filter(const LogDensity& log_density, const GaussianProposal& proposal, const TemperedOptions& options)
        : log_density_(log_density), proposal_(proposal), options_(options) {
        constexpr double log_root_two_pi = 0.5 * std::numbers::ln2 + 0.57236494292470008707;  // + ln sqrt(pi)
        log_peak_ = -proposal.factor.diagonal().array().log().sum() -
                    log_root_two_pi * static_cast<double>(proposal.mean.size());
    }

    Eigen::VectorXd parameters(const Eigen::VectorXd& z) const {
        return proposal_.mean + proposal_.factor.triangularView<Eigen::Lower>() * z;
    }

    double log_proposal(const Eigen::VectorXd& z) const { return log_peak_ - z.squaredNorm() / 2; }

    double log_ratio(const Eigen::VectorXd& z) const {
        const double value = log_density_(parameters(z));
        return std::isfinite(value) ? value - log_proposal(z) : -std::numeric_limits<double>::infinity();
    }

    Cloud draw() const {
        Cloud cloud{Eigen::MatrixXd(proposal_.mean.size(), options_.particles), Eigen::VectorXd(options_.particles)};
        for_each_in_parallel(cloud.size(), options_.threads, [&](int i) {
            cloud.z.col(i) = RandomStream(options_.seed, 0, i).normals(static_cast<int>(cloud.z.rows()));
            cloud.log_ratio[i] = log_ratio(cloud.z.col(i));
        });
        return cloud;
    }

    /// One Crank-Nicolson move of every particle at temperature b; returns the share that was accepted.
    double move(Cloud& cloud, double b, double step, std::uint64_t round) const {
        const double keep = std::sqrt(1 - step * step);
        std::vector<char> accepted(cloud.size(), 0);
        for_each_in_parallel(cloud.size(), options_.threads, [&](int i) {
            RandomStream random(options_.seed, round, i);
            const double log_u = std::log(1 - random.uniform());
            const Eigen::VectorXd z =
                keep * cloud.z.col(i) + step * random.normals(static_cast<int>(cloud.z.rows()));
            const double ratio = log_ratio(z);
            if (log_u < b * (ratio - cloud.log_ratio[i])) {
                cloud.z.col(i) = z;
                cloud.log_ratio[i] = ratio;
                accepted[i] = 1;
            }
        });
        return static_cast<double>(std::ranges::count(accepted, 1)) / cloud.size();
    }

    FilterStep record(const Cloud& cloud, double b, const Eigen::VectorXd& log_weights) const {
        FilterStep step{b, effective_samples(log_weights), Eigen::MatrixXd(cloud.size(), cloud.z.rows()), log_weights};
        for (int i = 0; i < cloud.size(); ++i) step.particles.row(i) = parameters(cloud.z.col(i));
        return step;
    }

private:
    const LogDensity& log_density_;
    const GaussianProposal& proposal_;
    const TemperedOptions& options_;
    double log_peak_ = 0;  // ln q(mean)
};

/// Weights after going from temperature b by db: w (pi / q)^db.
Eigen::VectorXd reweighted(const Eigen::VectorXd& log_weights, const Eigen::VectorXd& log_ratio, double db) {
    return log_weights + db * log_ratio;
}

/// The largest step of temperature that leaves the wanted effective sample size.
double temperature_step(const Eigen::VectorXd& log_weights, const Eigen::VectorXd& log_ratio, double b,
                        double wanted) {
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
    return high;  // never zero: particles without density go with the first step
}

void resample(Cloud& cloud, Eigen::VectorXd& log_weights, double u) {
    const Cloud before = cloud;
    const std::vector<int> chosen = low_variance_resample(log_weights, cloud.size(), u);
    for (int i = 0; i < cloud.size(); ++i) {
        cloud.z.col(i) = before.z.col(chosen[i]);
        cloud.log_ratio[i] = before.log_ratio[chosen[i]];
    }
    log_weights.setConstant(-std::log(cloud.size()));
}

}  // namespace

TemperedResult tempered_filter(const LogDensity& log_density, const GaussianProposal& proposal,
                               const TemperedOptions& options, const Progress& progress) {
    const Filter filter(log_density, proposal, options);
    TemperedResult result;

    // particles of the proposal, b = 0
    report(progress, "particles", 0);
    Cloud cloud = filter.draw();
    result.evaluations = options.particles;
    Eigen::VectorXd log_weights = Eigen::VectorXd::Constant(options.particles, -std::log(options.particles));
    result.history.push_back(filter.record(cloud, 0, log_weights));

    double b = 0, step = 0.5, accepted = 0;
    std::uint64_t round = 0;
    while (b < 1) {
        if (static_cast<int>(result.history.size()) > options.temperatures) {
            throw SolverFailure(fmt::format("the particle filter stands at temperature {:.3g} of 1 after {} steps: the "
                                            "measurements contradict each other or the model",
                                            b, options.temperatures));
        }
        // next temperature, weights, and the evidence that they add up to
        const double db = temperature_step(log_weights, cloud.log_ratio, b, options.least_effective * cloud.size());
        b = std::min(1.0, b + db);
        log_weights = reweighted(log_weights, cloud.log_ratio, db);
        result.log_evidence += normalise(log_weights);
        result.history.push_back(filter.record(cloud, b, log_weights));

        // equal weights again, but at the end, where nothing is gained by it
        if (b < 1) resample(cloud, log_weights, RandomStream(options.seed, ++round, cloud.size()).uniform());

        // moves; a longer step when too many of them are accepted, a shorter one when too few
        for (int i = 0; i < options.moves; ++i) {
            const double rate = filter.move(cloud, b, step, ++round);
            accepted += rate;
            result.evaluations += cloud.size();
            if (rate < 0.2) step *= 0.6;
            if (rate > 0.4) step = std::min(1.0, step * 1.5);
        }
        report(progress, "particles", b);
    }

    result.acceptance = accepted / (options.moves * static_cast<double>(result.history.size() - 1));
    result.history.push_back(filter.record(cloud, 1, log_weights));
    result.particles = result.history.back().particles;
    result.log_weights = log_weights;
    result.log_density.resize(cloud.size());
    for (int i = 0; i < cloud.size(); ++i) {
        result.log_density[i] = cloud.log_ratio[i] + filter.log_proposal(cloud.z.col(i));
    }
    return result;
}

}  // namespace palpate::identify
