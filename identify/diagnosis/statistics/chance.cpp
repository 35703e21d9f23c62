#include "identify/diagnosis/statistics/chance.h"

#include <boost/math/special_functions/erf.hpp>
#include <cmath>
#include <cstdint>
#include <numbers>

#include "identify/diagnosis/statistics/held_out.h"
#include "identify/numerics/random.h"

namespace palpate::identify {
namespace {

/// Errors of a right fit before its numbers are fitted, in sigmas (N x count).
Eigen::MatrixXd draw_errors(const Refit& fit, int count, std::uint64_t batch) {
    const Eigen::VectorXd noise = fit.V->weights().cwiseInverse();
    const Eigen::VectorXd spread = fit.nuisances.precisions.cwiseSqrt().cwiseInverse();
    Eigen::MatrixXd errors(noise.size(), count), nuisances(spread.size(), count);
    for (int c = 0; c < count; ++c) {
        RandomStream random(1, batch, static_cast<std::uint64_t>(c));
        errors.col(c) = noise.cwiseProduct(random.normals(static_cast<int>(noise.size())));
        nuisances.col(c) = spread.cwiseProduct(random.normals(static_cast<int>(spread.size())));
    }
    return errors + fit.nuisances.columns * nuisances;
}

}  // namespace

double largest_held_out(const Problem& problem, const Refit& fit, double probability) {
    constexpr int batches = 8, at_once = 50;  // 400 draws tell a standard deviation to 1/28
    const std::vector<int> group = held_out_groups(problem);
    const Whitening V = with_numbers_unknown(fit);
    Eigen::VectorXd logarithms(batches * at_once);
    for (int batch = 0; batch < batches; ++batch) {
        const Eigen::MatrixXd d = draw_errors(fit, at_once, static_cast<std::uint64_t>(batch));
        const Eigen::VectorXd chi_square = leave_out(V, d, group).chi_square;
        logarithms.segment(batch * at_once, at_once) =
            0.5 * (chi_square / static_cast<double>(problem.rows())).array().log();
    }
    const double mean = logarithms.mean();
    const double sd = std::sqrt((logarithms.array() - mean).square().mean());
    return std::exp(mean + std::numbers::sqrt2 * boost::math::erfc_inv(2 * probability) * sd);
}

}  // namespace palpate::identify
