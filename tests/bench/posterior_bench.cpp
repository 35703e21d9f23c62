// Particles next to the truth: a long chain that shares nothing with them but the density.
//
//   posterior_bench [--steps 20000] [--largest 480] [--rows 5 7]
//
// The chain is a random walk by preconditioned Crank-Nicolson moves in the fit's coordinates, without slopes, weights
// or temperatures [Cotter, Roberts, Stuart, White 2013], thousands of steps for each particle of `identify`; a second
// one from elsewhere tells how well it knows the answer itself. Prints a table in Markdown.

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cmath>

#include "identify/identify.h"
#include "identify/inference/maximum/calibrate.h"
#include "identify/inference/methods/methods.h"
#include "identify/inference/particles/proposal.h"
#include "identify/loading/twin.h"
#include "identify/numerics/random.h"
#include "mesh/errors.h"
#include "samples/lattice.h"

namespace {

using namespace palpate;
using namespace palpate::identify;

struct Moments {
    Eigen::VectorXd mean, sd;
};

/// Of the second half of a chain.
Moments long_chain(const Calibration& calibration, int steps, std::uint64_t seed) {
    const PositionDomain& domain = calibration.domain;
    const auto P = static_cast<int>(calibration.fit.theta.size());
    GaussianProposal q = laplace_proposal(calibration.fit, calibration.prior);
    const auto log_ratio = [&](const Eigen::VectorXd& z) {
        try {
            const Eigen::VectorXd theta = q.parameters(z).col(0);
            return calibration.prior.log_density(theta) -
                   domain.chi_squared(domain.predict(theta, 1, &calibration.fit.prediction)) / 2 + z.squaredNorm() / 2;
        } catch (const SolverFailure&) {
            return -std::numeric_limits<double>::infinity();
        }
    };
    Eigen::VectorXd z = RandomStream(seed, 0, 0).normals(P);
    double now = log_ratio(z), length = 0.5;
    Eigen::VectorXd sum = Eigen::VectorXd::Zero(P), squares = sum;
    for (int step = 1; step <= steps; ++step) {
        RandomStream random(seed, 1, step);
        const double log_u = std::log(1 - random.uniform());
        const Eigen::VectorXd there = std::sqrt(1 - length * length) * z + length * random.normals(P);
        const double ratio = log_ratio(there);
        const bool accepted = log_u < ratio - now;
        if (accepted) {
            z = there;
            now = ratio;
        }
        // adapts in its first quarter alone
        if (step < steps / 4) length = std::clamp(length * (accepted ? 1.02 : 0.994), 0.01, 0.99);
        if (step <= steps / 2) continue;
        const Eigen::VectorXd off = q.parameters(z).col(0) - q.mean;
        sum += off;
        squares += off.cwiseAbs2();
    }
    const double n = steps - steps / 2;
    const Eigen::VectorXd mean = sum / n;
    return {q.mean + mean, (squares / n - mean.cwiseAbs2()).cwiseMax(0).cwiseSqrt()};
}

Moments of_particles(const IdentifyResult& result, const Eigen::VectorXd& units) {
    const FilterStep& last = result.history.back();
    const Eigen::VectorXd weights = last.log_weights.array().exp();
    Moments moments{Eigen::VectorXd(units.size()), Eigen::VectorXd(units.size())};
    for (Eigen::Index p = 0; p < units.size(); ++p) {
        const Eigen::ArrayXd theta = (last.particles.col(p).array() / units[p]).log();
        moments.mean[p] = theta.matrix().dot(weights);
        moments.sd[p] = std::sqrt((theta - moments.mean[p]).square().matrix().dot(weights));
    }
    return moments;
}

struct Difference {
    double mean, sd_ratio;  // rms over the numbers in sd; mean of the ratios
};

Difference between(const Moments& a, const Moments& truth) {
    return {std::sqrt(((a.mean - truth.mean).array() / truth.sd.array()).square().mean()),
            (a.sd.array() / truth.sd.array()).mean()};
}

struct Problem {
    skeleton::Model model;
    MeasurementSet set;
    IdentifyOptions how;
};

/// A block with markers on all spheres, its links as smooth as the prior says. Noise [mm].
Problem block(const Eigen::Vector3i& n, Scope scope, skeleton::EquilibriumLaw law, double noise) {
    Problem problem;
    problem.model = samples::make_lattice("block", n, 1);
    problem.model.law = law;
    skeleton::Model truth = problem.model;
    for (std::size_t l = 0; l < truth.links.size(); ++l) {
        const double x = truth.spheres[truth.links[l].a].center.x() / 40;
        const double size = scope == Scope::uniform ? 0.2 : 0.4 * std::sin(x);
        truth.links[l].stiffness[0] *= std::exp(size);
        truth.links[l].stiffness[1] *= std::exp(-size);
    }
    std::vector<LoadState> states;
    for (int p = 0; p < 6; ++p) {
        RandomStream random(3, 0, p);
        const auto sphere = static_cast<std::size_t>(static_cast<double>(truth.spheres.size() - 1) * random.uniform());
        states.push_back(
            {.probe = p + 1, .contacts = {{truth.spheres[sphere].center, 2 * random.normals(3).normalized(), 0}}});
    }
    problem.set = simulate_measurements(truth, states, markers_on_spheres(problem.model), noise, 1);
    problem.how.scope = scope;
    problem.how.fixed = {skeleton::Stiffness::torsion};
    problem.how.law = law == skeleton::EquilibriumLaw::linear ? LawChoice::linear : LawChoice::large_rotation;
    return problem;
}

}  // namespace

int main(int argc, char** argv) {
    CLI::App app("Particles next to long chains.");
    int steps = 20000, largest = 480;
    app.add_option("--steps", steps, "Of each chain");
    app.add_option("--largest", largest, "Numbers at most");
    std::vector<int> rows;
    app.add_option("--rows", rows, "These rows of the table alone, 1 to 7");
    CLI11_PARSE(app, argc, argv);
    fmt::print(
        "| numbers | law | noise, mm | particles | effective | R-hat | mean off, sd | sd, ratio | another chain: mean "
        "off, sd | "
        "sd, "
        "ratio | equilibria | of the chain | seconds | of the chain "
        "|\n|---|---|---|---|---|---|---|---|---|---|---|---|---|---|\n");
    using enum skeleton::EquilibriumLaw;
    const std::vector<Problem> problems{
        block({3, 3, 2}, Scope::uniform, large_rotation, 0.4), block({3, 3, 2}, Scope::links, large_rotation, 0.4),
        block({4, 4, 4}, Scope::links, linear, 0.4),           block({4, 4, 4}, Scope::links, large_rotation, 0.4),
        block({4, 4, 4}, Scope::links, linear, 0.04),          block({4, 4, 4}, Scope::links, large_rotation, 0.04),
        block({5, 5, 4}, Scope::links, linear, 0.04)};
    for (int row = 1; const Problem& problem : problems) {
        if (std::ranges::count(rows, row++) == 0 && !rows.empty()) continue;
        const auto watch = std::chrono::steady_clock::now();
        const auto seconds = [&] {
            return std::chrono::duration<double>(std::chrono::steady_clock::now() - watch).count();
        };
        const IdentifyResult found = identify::identify(problem.model, problem.set, problem.how);
        const double took = seconds();
        const auto P = static_cast<int>(found.posterior.size());
        if (P > largest) continue;
        const Calibration calibration =
            calibrate(problem.model, informative_readings(problem.model, problem.set), problem.how, {});
        const Moments truth = long_chain(calibration, steps, 11), again = long_chain(calibration, steps, 12);
        const Difference ours = between(of_particles(found, calibration.domain.parameters().units()), truth),
                         theirs = between(again, truth);
        const int states = found.states;
        fmt::print(
            "| {} | {} | {:g} | {} | {:.0f} | {:.3f} | {:.3f} | {:.3f} | {:.3f} | {:.3f} | {} | {} | {:.3g} | {:.3g} "
            "|\n",
            P, skeleton::law_names[static_cast<std::size_t>(problem.model.law)], *problem.set.position_noise,
            found.history.back().particles.rows(), found.effective_samples, found.r_hat, ours.mean, ours.sd_ratio,
            theirs.mean, theirs.sd_ratio, found.equilibria, steps * states, took, (seconds() - took) / 2);
        std::fflush(stdout);
    }
    return 0;
}
