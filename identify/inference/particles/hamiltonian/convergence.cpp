#include "identify/inference/particles/hamiltonian/convergence.h"

#include <algorithm>
#include <cmath>

namespace palpate::identify {
namespace {

double variance_of(const Eigen::VectorXd& values) {
    const auto n = static_cast<double>(values.size());
    return n > 1 ? (values.array() - values.mean()).square().sum() / (n - 1) : 0;
}

/// Means of each chain of each cloud, of one quantity.
Eigen::VectorXd chain_means(const std::vector<Eigen::MatrixXd>& clouds, int chains, Eigen::Index quantity) {
    Eigen::VectorXd means = Eigen::VectorXd::Zero(std::ssize(clouds) * chains);
    for (std::size_t c = 0; c < clouds.size(); ++c) {
        const auto rounds = static_cast<double>(clouds[c].cols()) / chains;
        for (Eigen::Index i = 0; i < clouds[c].cols(); ++i) {
            means[static_cast<Eigen::Index>(c) * chains + i % chains] += clouds[c](quantity, i) / rounds;
        }
    }
    return means;
}

}  // namespace

Convergence convergence(const std::vector<Eigen::MatrixXd>& clouds, int chains) {
    const Eigen::Index quantities = clouds.front().rows(), n = clouds.front().cols();
    const double rounds = static_cast<double>(n) / chains;
    const double all = static_cast<double>(n * std::ssize(clouds));
    Convergence result;
    double correlation_time = 0;  // summed
    for (Eigen::Index q = 0; q < quantities; ++q) {
        Eigen::VectorXd means(std::ssize(clouds));
        double within = 0;
        for (std::size_t c = 0; c < clouds.size(); ++c) {
            means[static_cast<Eigen::Index>(c)] = clouds[c].row(q).mean();
            within += variance_of(clouds[c].row(q)) / static_cast<double>(clouds.size());
        }
        if (within == 0) continue;
        result.r_hat = std::max(result.r_hat, std::sqrt((all - 2) / all + variance_of(means) / within));
        correlation_time += rounds * variance_of(chain_means(clouds, chains, q)) / within;
    }
    const double time = std::max(1.0, correlation_time / static_cast<double>(quantities));
    result.effective = all / time;
    return result;
}

}  // namespace palpate::identify
