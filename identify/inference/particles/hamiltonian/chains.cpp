#include "identify/inference/particles/hamiltonian/chains.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "identify/numerics/parallel.h"
#include "identify/numerics/random.h"

namespace palpate::identify {
namespace {

constexpr double quarter_turn = std::numbers::pi / 2;
constexpr double jitter = 0.15;  // of the angle, either way

}  // namespace

void HamiltonianMoves::evaluate(Chains& chains) {
    const Eigen::MatrixXd theta = q_.parameters(chains.z);
    Eigen::MatrixXd gradients = Eigen::MatrixXd::Zero(theta.rows(), theta.cols());
    chains.log_ratio.resize(theta.cols());
    for_each_in_parallel(chains.size(), threads_, [&](int i) {
        Eigen::VectorXd gradient = Eigen::VectorXd::Zero(theta.rows());
        const double value = density_(theta.col(i), gradient);
        const bool stands = std::isfinite(value) && gradient.allFinite();
        chains.log_ratio[i] = stands ? value - log_proposal(chains.z.col(i)) : -std::numeric_limits<double>::infinity();
        if (stands) gradients.col(i) = gradient;
    });
    chains.gradient = q_.gradients_by_z(gradients);
    for (int i = 0; i < chains.size(); ++i) {
        // without a density there is no kick, and the trajectory is rejected in the end
        if (std::isfinite(chains.log_ratio[i])) chains.gradient.col(i) += chains.z.col(i);
    }
    evaluations_ += chains.size();
}

Chains HamiltonianMoves::draw(int count, std::uint64_t round) {
    const auto P = static_cast<int>(q_.mean.size());
    Chains chains;
    chains.z.resize(P, count);
    for (int i = 0; i < count; ++i) chains.z.col(i) = RandomStream(seed_, round, i).normals(P);
    evaluate(chains);
    return chains;
}

double HamiltonianMoves::move(Chains& chains, double b, double angle, std::uint64_t round) {
    const auto P = static_cast<int>(chains.z.rows());
    const int W = chains.size();
    Eigen::MatrixXd p(P, W);
    Eigen::VectorXd log_u(W);
    for (int i = 0; i < W; ++i) {
        RandomStream random(seed_, round, i);
        log_u[i] = std::log(1 - random.uniform());
        p.col(i) = random.normals(P);
    }
    const auto energy = [&](const Chains& at) -> Eigen::ArrayXd {
        return (at.z.colwise().squaredNorm() + p.colwise().squaredNorm()).transpose().array() / 2 -
               b * at.log_ratio.array();
    };
    const Eigen::ArrayXd before = energy(chains);

    const double h = angle * (1 + jitter * (2 * RandomStream(seed_, round, W).uniform() - 1));
    const int steps = std::max(1, static_cast<int>(std::lround(quarter_turn / h)));
    Chains there = chains;
    std::vector<bool> stands(static_cast<std::size_t>(W), true);
    for (int step = 0; step < steps; ++step) {
        p += h / 2 * b * there.gradient;
        const Eigen::MatrixXd turned = std::cos(h) * there.z + std::sin(h) * p;
        p = std::cos(h) * p - std::sin(h) * there.z;
        there.z = turned;
        evaluate(there);
        p += h / 2 * b * there.gradient;
        for (int i = 0; i < W; ++i) stands[i] = stands[i] && std::isfinite(there.log_ratio[i]);
    }

    const Eigen::ArrayXd risen = energy(there) - before;
    double accepted = 0;
    for (int i = 0; i < W; ++i) {
        if (!stands[i] || std::isnan(risen[i])) continue;
        accepted += std::min(1.0, std::exp(-risen[i]));
        if (!(log_u[i] < -risen[i])) continue;
        chains.z.col(i) = there.z.col(i);
        chains.log_ratio[i] = there.log_ratio[i];
        chains.gradient.col(i) = there.gradient.col(i);
    }
    return accepted / W;
}

}  // namespace palpate::identify
