#include "identify/inference/particles/hamiltonian/hamiltonian_filter.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <numeric>

#include "identify/inference/particles/hamiltonian/chains.h"
#include "identify/inference/particles/hamiltonian/convergence.h"
#include "identify/inference/particles/hamiltonian/evidence.h"
#include "identify/numerics/random.h"
#include "mesh/errors.h"

namespace palpate::identify {
namespace {

constexpr double first_angle = 0.2;                // of a step: good for curvatures up to a hundred times those of q
constexpr double least_angle = 0.005;              // 314 steps to a quarter turn: the density must jump
constexpr double largest_angle = 0.8;              // two steps to a quarter turn
constexpr double wanted_acceptance = 0.8;          // the best where a step costs much more than a momentum
constexpr double acceptable = 0.5;                 // while settling
constexpr int draws_per_chain = 4;                 // of q, that tell its evidence
constexpr int settled_moves = 3, most_moves = 24;  // at b = 1, before the first particle
constexpr Eigen::Index watched = 64;               // of the directions that the measurements inform most
constexpr double is_informed = 1;                  // ratio of data to prior information

/// One cloud: annealing, then moves at b = 1.
class HamiltonianFilter {
public:
    HamiltonianFilter(const DensityWithGradient& density, const GaussianProposal& q, const HamiltonianOptions& options,
                      std::uint64_t seed)
        : moves_(density, q, seed, options.threads), options_(options) {}

    /// From b = 0 to 1, until the chains have settled there.
    void anneal(const std::function<void(double)>& tell) {
        start();
        double b = 0;
        while (b < 1) {
            b = next_temperature(b);
            move(b);
            stay_affordable();
            nodes_.push_back(temperature_node(b, chains_.log_ratio, chains_.size()));
            record(b);
            tell(b);
        }
        settle();
    }
    /// Moves at b = 1. The first ones have to be affordable; what continues them is predicted to be.
    void sample(int rounds, const std::function<void(double)>& tell) {
        const bool are_first = rounds_.empty();
        for (int i = 0; i < rounds; ++i) {
            accepted_.push_back(move(1));
            rounds_.push_back(chains_);
            if (are_first) stay_affordable();
            tell((i + 1.0) / rounds);
        }
    }
    void leave_out(int rounds) {
        rounds_.erase(rounds_.begin(), rounds_.begin() + rounds);
        accepted_.erase(accepted_.begin(), accepted_.begin() + rounds);
    }

    const std::vector<Chains>& rounds() const { return rounds_; }  // at b = 1
    const std::vector<TemperatureNode>& nodes() const { return nodes_; }
    const std::vector<FilterStep>& history() const { return history_; }
    double acceptance() const {
        return std::accumulate(accepted_.begin(), accepted_.end(), 0.0) / static_cast<double>(accepted_.size());
    }
    int evaluations() const { return moves_.evaluations(); }

private:
    /// Draws of q that have a density.
    void start() {
        const Chains drawn = moves_.draw(draws_per_chain * options_.chains, round_++);
        std::vector<int> good;
        for (int i = 0; i < drawn.size(); ++i) {
            if (std::isfinite(drawn.log_ratio[i])) good.push_back(i);
        }
        if (good.empty()) {
            throw SolverFailure("no particle has a weight: none of the tried stiffnesses explains the measurements");
        }
        nodes_.push_back(temperature_node(0, drawn.log_ratio(good), static_cast<double>(good.size())));
        std::vector<int> chosen(static_cast<std::size_t>(options_.chains));
        for (std::size_t i = 0; i < chosen.size(); ++i) chosen[i] = good[i % good.size()];
        chains_ = {drawn.z(Eigen::all, chosen), drawn.log_ratio(chosen), drawn.gradient(Eigen::all, chosen)};
        record(0);
    }

    double next_temperature(double b) const {
        const double sd = std::sqrt(nodes_.back().variance);
        double step = 1 / std::max(1.0, sd);
        if (b > 0) step = std::clamp(step, b, 2 * b);
        return b + step > 0.99 ? 1 : b + step;
    }

    /// One move; until the chains have settled the angle follows how many are accepted.
    double move(double b) {
        const double accepted = moves_.move(chains_, b, angle_, round_++);
        if (!is_settled_) {
            angle_ = std::min(largest_angle, angle_ * std::clamp(std::exp(accepted - wanted_acceptance), 0.6, 1.15));
            if (angle_ < least_angle) {
                throw SolverFailure("the particles cannot move: the posterior's density jumps where they are");
            }
        }
        return accepted;
    }

    void stay_affordable() const {
        if (moves_.evaluations() <= options_.evaluations / 2) return;
        throw SolverFailure("the particles move too slowly: the posterior's curvature changes too much");
    }

    void settle() {
        int good = 0;
        for (int i = 0; i < most_moves && good < settled_moves; ++i) {
            if (move(1) >= acceptable) ++good;
            stay_affordable();
        }
        is_settled_ = true;
    }

    void record(double b) {
        const int W = chains_.size();
        history_.push_back({b, static_cast<double>(W), moves_.parameters(chains_.z).transpose(),
                            Eigen::VectorXd::Constant(W, -std::log(W))});
    }

    HamiltonianMoves moves_;
    const HamiltonianOptions& options_;
    Chains chains_;
    std::vector<Chains> rounds_;
    std::vector<double> accepted_;  // mean of each round
    std::vector<TemperatureNode> nodes_;
    std::vector<FilterStep> history_;
    double angle_ = first_angle;
    bool is_settled_ = false;
    std::uint64_t round_ = 0;
};

/// Directions that the measurements inform, and the density (quantities x draws).
Eigen::MatrixXd watched_quantities(const std::vector<Chains>& rounds, const GaussianProposal& q) {
    const Eigen::Index informed = std::min(watched, (q.spectrum.values.array() > is_informed).count());
    const Eigen::Index W = rounds.front().size();
    Eigen::MatrixXd quantities(informed + 1, W * std::ssize(rounds));
    for (std::size_t i = 0; i < rounds.size(); ++i) {
        auto own = quantities.middleCols(static_cast<Eigen::Index>(i) * W, W);
        if (informed > 0) own.topRows(informed) = q.spectrum.vectors.leftCols(informed).transpose() * rounds[i].z;
        own.bottomRows<1>() = rounds[i].log_ratio.transpose() - rounds[i].z.colwise().squaredNorm() / 2;
    }
    return quantities;
}

/// Particles, evidence and diagnostics of both clouds. W: chains of each; `rounds_wanted`: of each cloud, at least.
TemperedResult gathered(const std::deque<HamiltonianFilter>& clouds, const GaussianProposal& q,
                        const Convergence& agreed, int W, int rounds_wanted) {
    TemperedResult result;
    // particles: every so many rounds, as those in between tell little more
    const auto rounds = static_cast<int>(clouds.front().rounds().size());
    const int stride = std::max(1, rounds / rounds_wanted), kept = (rounds + stride - 1) / stride;
    const int N = 2 * W * kept;
    result.particles.resize(N, q.mean.size());
    result.log_density.resize(N);
    std::vector<Evidence> evidence;
    int row = 0;
    for (const HamiltonianFilter& cloud : clouds) {
        Eigen::VectorXd ratios(W * rounds);
        for (int i = 0; i < rounds; ++i) {
            const Chains& at = cloud.rounds()[i];
            ratios.segment(i * W, W) = at.log_ratio;
            if (i % stride != 0) continue;
            result.particles.middleRows(row, W) = q.parameters(at.z).transpose();
            result.log_density.segment(row, W) =
                at.log_ratio.array() + q.log_peak() - at.z.colwise().squaredNorm().transpose().array() / 2;
            row += W;
        }
        // the last temperature is seen by all rounds
        std::vector<TemperatureNode> nodes = cloud.nodes();
        nodes.back() = temperature_node(1, ratios, agreed.effective / 2);
        evidence.push_back(integrated_evidence(nodes));
        result.acceptance += cloud.acceptance() / 2;
        result.evaluations += cloud.evaluations();
        result.history.insert(result.history.end(), cloud.history().begin(), cloud.history().end());
    }
    const double independent = std::clamp(agreed.effective, 1.0, static_cast<double>(N));
    std::ranges::stable_sort(result.history, {}, &FilterStep::temperature);
    result.log_weights = Eigen::VectorXd::Constant(N, -std::log(N));
    result.mode.assign(static_cast<std::size_t>(N), 0);
    const Evidence whole = together(evidence[0], evidence[1]);
    result.log_evidence = whole.log_value;
    result.log_evidence_sd = whole.sd;
    result.r_hat = agreed.r_hat;
    result.independent = static_cast<int>(independent);
    result.history.push_back({1, independent, result.particles, result.log_weights});
    return result;
}

}  // namespace

TemperedResult hamiltonian_filter(const DensityWithGradient& density, const GaussianProposal& q,
                                  const HamiltonianOptions& options, const Progress& progress) {
    report(progress, "particles", 0);
    std::deque<HamiltonianFilter> clouds;
    for (std::uint64_t c = 0; c < 2; ++c) clouds.emplace_back(density, q, options, 2 * options.seed + c);
    const auto share_of = [&](double from, double to) {
        return [&, from, to, cloud = 0](double done) mutable {
            report(progress, "particles", from + (to - from) * (cloud + done) / 2);
            if (done >= 1) cloud = 1;
        };
    };
    const std::function<void(double)> annealed = share_of(0, 0.3);
    for (HamiltonianFilter& cloud : clouds) cloud.anneal(annealed);

    const int first = (options.particles / 2 + options.chains - 1) / options.chains;
    Convergence agreed;
    double told = 0.3;
    for (int more = first;; more *= 2) {
        const std::function<void(double)> sampled = share_of(told, told + (1 - told) / 2);
        told += (1 - told) / 2;
        int evaluations = 0;
        std::vector<Eigen::MatrixXd> quantities;
        for (HamiltonianFilter& cloud : clouds) {
            const int before = cloud.evaluations();
            cloud.sample(more, sampled);
            evaluations += 2 * (cloud.evaluations() - before) + cloud.evaluations();  // of the next extension, too
            if (more == 2 * first) cloud.leave_out(first);
            quantities.push_back(watched_quantities(cloud.rounds(), q));
        }
        agreed = convergence(quantities, options.chains);
        const bool is_enough = agreed.effective >= options.effective && agreed.r_hat <= good_r_hat;
        if (is_enough || evaluations > options.evaluations) break;
    }

    return gathered(clouds, q, agreed, options.chains, first);
}

}  // namespace palpate::identify
