#include "identify/inference/particles/tempered_filter.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "identify/inference/particles/resampling.h"
#include "identify/numerics/parallel.h"
#include "identify/numerics/random.h"
#include "mesh/errors.h"

namespace palpate::identify {
namespace {

/// With more particles than this for each parameter, copies that do not part are told apart by the rest: they may sit
/// in modes of their own.
constexpr double particles_per_parameter = 4;

/// More draws than this many times N are not made: moves are cheaper then.
constexpr double most_draws = 4;

/// Copies part so much further after the last temperature, as their spread is what is told.
constexpr double further_at_the_end = 2;

/// The cloud in whitened coordinates, a column per particle.
struct Cloud {
    Eigen::MatrixXd z;          // (P x N)
    std::vector<int> from;      // the Gaussian that they belong to (N)
    Eigen::VectorXd log_ratio;  // ln pi - ln q of each (N)

    int size() const { return static_cast<int>(z.cols()); }
};

class Filter {
public:
    Filter(const LogDensity& log_density, const GaussianMixture& q, const TemperedOptions& options)
        : log_density_(log_density), q_(q), options_(options) {}

    /// ln pi - ln q of each particle.
    Eigen::VectorXd log_ratio(const Eigen::MatrixXd& z, const std::vector<int>& from) const {
        const Eigen::MatrixXd theta = q_.parameters(z, from);
        Eigen::VectorXd ratio(z.cols());
        for_each_in_parallel(static_cast<int>(z.cols()), options_.threads, [&](int i) {
            const double value = log_density_(theta.col(i));
            ratio[i] = std::isfinite(value) ? value - q_.log_density(theta.col(i), z.col(i), from[i])
                                            : -std::numeric_limits<double>::infinity();
        });
        return ratio;
    }

    /// Adds N particles of q, as many of each Gaussian.
    void draw(Cloud& cloud) const {
        const int before = cloud.size(), count = options_.particles;
        Eigen::MatrixXd z(q_.dimension(), count);
        std::vector<int> from;
        for (int i = before; i < before + count; ++i) {
            z.col(i - before) = RandomStream(options_.seed, 0, i).normals(q_.dimension());
            from.push_back(i % q_.modes());
        }
        cloud.z.conservativeResize(q_.dimension(), before + count);
        cloud.z.rightCols(count) = z;
        cloud.log_ratio.conservativeResize(before + count);
        cloud.log_ratio.tail(count) = log_ratio(z, from);
        cloud.from.insert(cloud.from.end(), from.begin(), from.end());
    }

    struct Moved {
        double accepted;  // share of the particles
        double distance;  // mean square of the way that they went, in z
    };

    /// One Crank-Nicolson move of every particle at temperature b.
    Moved move(Cloud& cloud, double b, double step, std::uint64_t round) const {
        const double keep = std::sqrt(1 - step * step);
        Eigen::MatrixXd z(cloud.z.rows(), cloud.size());
        Eigen::VectorXd log_u(cloud.size());
        for (int i = 0; i < cloud.size(); ++i) {
            RandomStream random(options_.seed, round, i);
            log_u[i] = std::log(1 - random.uniform());
            z.col(i) = keep * cloud.z.col(i) + step * random.normals(static_cast<int>(z.rows()));
        }
        const Eigen::VectorXd ratio = log_ratio(z, cloud.from);

        int accepted = 0;
        double distance = 0;
        for (int i = 0; i < cloud.size(); ++i) {
            if (!(log_u[i] < b * (ratio[i] - cloud.log_ratio[i]))) continue;
            ++accepted;
            distance += (z.col(i) - cloud.z.col(i)).squaredNorm();
            cloud.z.col(i) = z.col(i);
            cloud.log_ratio[i] = ratio[i];
        }
        return {static_cast<double>(accepted) / cloud.size(), distance / cloud.size()};
    }

    FilterStep record(const Cloud& cloud, double b, const Eigen::VectorXd& log_weights) const {
        return {b, effective_samples(log_weights), q_.parameters(cloud.z, cloud.from).transpose(), log_weights};
    }

private:
    const LogDensity& log_density_;
    const GaussianMixture& q_;
    const TemperedOptions& options_;
};

void resample(Cloud& cloud, Eigen::VectorXd& log_weights, double u) {
    const Cloud before = cloud;
    const std::vector<int> chosen = low_variance_resample(log_weights, cloud.size(), u);
    for (int i = 0; i < cloud.size(); ++i) {
        cloud.z.col(i) = before.z.col(chosen[i]);
        cloud.from[i] = before.from[chosen[i]];
        cloud.log_ratio[i] = before.log_ratio[chosen[i]];
    }
    log_weights.setConstant(-std::log(cloud.size()));
}

/// Moves with a step that adapts: longer when too many are accepted, shorter when too few.
class Mover {
public:
    Mover(const Filter& filter, int moves) : filter_(filter), moves_(moves) {}

    /// One move of all particles.
    Filter::Moved once(Cloud& cloud, double b) {
        const Filter::Moved moved = filter_.move(cloud, b, step_, ++round_);
        accepted_ += moved.accepted;
        ++made_;
        if (moved.accepted < few) step_ *= 0.6;
        if (moved.accepted > many) step_ = std::min(1.0, step_ * 1.5);
        return moved;
    }

    /// Moves until copies have parted: until the squares of their ways add up to half of that between two
    /// particles, each of which lies `spread` from the middle in mean square. False when they did not; where they have
    /// to, no more moves are made than show that they will not.
    bool part(Cloud& cloud, double b, double spread, bool have_to) {
        double path_length = 0;
        for (int left = moves_ - 1; left >= 0 && path_length < spread; --left) {
            const Filter::Moved moved = once(cloud, b);
            path_length += moved.distance;
            const bool step_has_grown = moved.accepted <= many;
            if (have_to && step_has_grown && path_length + hopeful * left * moved.distance < spread) return false;
        }
        return path_length >= spread;
    }

    std::uint64_t next_round() { return ++round_; }
    double acceptance() const { return made_ > 0 ? accepted_ / made_ : 0; }
    int made() const { return made_; }

private:
    static constexpr double few = 0.2, many = 0.4;  // of moves accepted
    static constexpr double hopeful = 1.5;          // the way of later moves, to that of the last one

    const Filter& filter_;
    int moves_;
    double step_ = 0.5, accepted_ = 0;
    int made_ = 0;
    std::uint64_t round_ = 0;
};

/// Mean square distance of weighted particles from the mean of those of their Gaussian, in z.
double spread_of(const Cloud& cloud, const Eigen::VectorXd& log_weights) {
    const Eigen::VectorXd weights = log_weights.array().exp();
    const int modes = 1 + *std::ranges::max_element(cloud.from);
    Eigen::MatrixXd sums = Eigen::MatrixXd::Zero(cloud.z.rows(), modes);
    Eigen::VectorXd shares = Eigen::VectorXd::Zero(modes);
    for (int i = 0; i < cloud.size(); ++i) {
        sums.col(cloud.from[i]) += weights[i] * cloud.z.col(i);
        shares[cloud.from[i]] += weights[i];
    }
    double spread = 0;
    for (int i = 0; i < cloud.size(); ++i) {
        if (weights[i] == 0) continue;
        spread += weights[i] * (cloud.z.col(i) - sums.col(cloud.from[i]) / shares[cloud.from[i]]).squaredNorm();
    }
    return spread;
}

Eigen::VectorXd equal_weights(int n) { return Eigen::VectorXd::Constant(n, -std::log(n)); }

/// Draws of q, weighed by pi / q at once, as many as it takes to be worth the wanted number of equal ones; false, and
/// nothing done, where that is not within `most_draws` N.
bool weigh_draws(const Filter& filter, const TemperedOptions& options, Cloud& cloud, TemperedResult& result) {
    const double wanted = options.least_effective * options.particles;
    const auto weights_of = [](const Cloud& drawn, Eigen::VectorXd& log_weights) {
        log_weights = equal_weights(drawn.size()) + drawn.log_ratio;
        return normalise(log_weights);
    };
    Cloud drawn = cloud;
    Eigen::VectorXd log_weights;
    double log_evidence = weights_of(drawn, log_weights), effective = effective_samples(log_weights);
    while (effective < wanted) {
        if (most_draws * effective * options.particles < wanted * drawn.size()) return false;
        filter.draw(drawn);
        log_evidence = weights_of(drawn, log_weights);
        effective = effective_samples(log_weights);
    }
    cloud = std::move(drawn);
    result.log_weights = std::move(log_weights);
    result.log_evidence = log_evidence;
    return true;
}

/// The weighed particles, from b = 0 to 1; false when copies do not part.
bool temper(const Filter& filter, const TemperedOptions& options, Mover& mover, Cloud& cloud, TemperedResult& result,
            const Progress& progress) {
    if (weigh_draws(filter, options, cloud, result)) return true;
    double b = 0;
    while (b < 1) {
        if (static_cast<int>(result.history.size()) > options.temperatures) {
            throw SolverFailure(
                fmt::format("the particle filter stalled at temperature {:.3g} of 1 after {} steps: the measurements "
                            "contradict each other or the model",
                            b, options.temperatures));
        }
        // next temperature, weights, and the evidence that they add up to
        const double db =
            temperature_step(result.log_weights, cloud.log_ratio, b, options.least_effective * cloud.size());
        b = std::min(1.0, b + db);
        result.log_weights = reweighted(result.log_weights, cloud.log_ratio, db);
        result.log_evidence += normalise(result.log_weights);
        result.history.push_back(filter.record(cloud, b, result.log_weights));
        const double spread = spread_of(cloud, result.log_weights);

        // equal weights again, but at the end, where nothing is gained by it
        if (b < 1) {
            resample(cloud, result.log_weights, RandomStream(options.seed, mover.next_round(), cloud.size()).uniform());
        }
        const bool have_to = particles_per_parameter * static_cast<double>(cloud.z.rows()) > cloud.size();
        if (!mover.part(cloud, b, spread, have_to) && have_to) return false;
        if (b == 1) mover.part(cloud, b, further_at_the_end * spread, false);
        report(progress, "particles", b);
    }
    return true;
}

}  // namespace

TemperedResult tempered_filter(const LogDensity& log_density, const std::vector<GaussianProposal>& proposals,
                               const TemperedOptions& options, const Progress& progress) {
    const GaussianMixture q(proposals);
    const Filter filter(log_density, q, options);
    Mover mover(filter, options.moves);

    // particles of the proposal, b = 0
    report(progress, "particles", 0);
    Cloud cloud;
    filter.draw(cloud);
    const Cloud drawn = cloud;
    TemperedResult result;
    result.log_weights = equal_weights(options.particles);
    result.history.push_back(filter.record(cloud, 0, result.log_weights));

    if (options.at_once) {
        result.weighed = weigh_draws(filter, options, cloud, result);
        result.evaluations = cloud.size();
        if (!result.weighed) return result;
    } else {
        result.weighed = temper(filter, options, mover, cloud, result, progress);
    }
    if (!result.weighed) {
        // all of them again, unweighed, by the posterior's own moves; those without density wait for their first one
        cloud = drawn;
        result.history.resize(1);
        result.log_weights = equal_weights(options.particles);
        for (int i = 0; i < 2 * options.moves; ++i) {
            mover.once(cloud, 1);
            report(progress, "particles", static_cast<double>(i) / (2 * options.moves));
        }
        result.log_evidence = filter.log_ratio(Eigen::MatrixXd::Zero(q.dimension(), 1), {0})[0];
    }

    result.history.push_back(filter.record(cloud, 1, result.log_weights));
    result.particles = result.history.back().particles;
    result.acceptance = mover.acceptance();
    result.evaluations = std::max(cloud.size(), drawn.size()) + mover.made() * options.particles;
    result.log_density.resize(cloud.size());
    result.mode.resize(static_cast<std::size_t>(cloud.size()));
    for (int i = 0; i < cloud.size(); ++i) {
        const Eigen::VectorXd theta = result.particles.row(i);
        result.log_density[i] = cloud.log_ratio[i] + q.log_density(theta, cloud.z.col(i), cloud.from[i]);
        Eigen::Index densest = 0;
        q.log_densities(theta, cloud.z.col(i), cloud.from[i]).maxCoeff(&densest);
        result.mode[i] = static_cast<int>(densest);
    }
    return result;
}

}  // namespace palpate::identify
