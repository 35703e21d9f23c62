#include "identify/inference/maximum/modes.h"

#include <algorithm>
#include <functional>
#include <optional>

#include "identify/numerics/random.h"
#include "mesh/errors.h"

namespace palpate::identify {
namespace {

constexpr int starts = 8;  // a choice: a mode that draws a third of the starts is missed once in 26 times, (2/3)^8
constexpr int most_parameters = 64, most_spheres = 4000;  // that several fits are made for
constexpr double found = 1e-4;                            // of half the chi^2, that a fit has left to gain
constexpr double widest_start = 1;                        // sd of ln stiffness
constexpr double negligible = 20;                         // less of ln posterior density than the best
constexpr double same = 0.3;                              // sd of the posterior between two ends of one ascent
constexpr std::uint64_t start_round = 1 << 29;            // of the random streams

bool is_cheap(const PositionDomain& domain) {
    if (domain.parameters().size() > most_parameters) return false;
    return domain.spheres() * static_cast<double>(domain.states().size()) <= most_spheres;
}

std::optional<FitResult> try_fit(const PositionDomain& domain, const LogNormalPrior& prior,
                                 const Eigen::VectorXd& start, int threads) {
    try {
        return fit_map(domain, prior, start, threads, {.tolerance = found});
    } catch (const SolverFailure&) {  // no equilibrium there
        return std::nullopt;
    }
}

/// Distance in sd of what is known at one of them.
double distance(const FitResult& mode, const FitResult& other, const LogNormalPrior& prior) {
    const Eigen::VectorXd dv = prior.whitened(other.theta - mode.theta + prior.mean);
    const Eigen::ArrayXd along = mode.spectrum.vectors.transpose() * dv;
    return std::sqrt(dv.squaredNorm() + (mode.spectrum.values.array() * along.square()).sum());
}

}  // namespace

std::vector<FitResult> find_modes(const PositionDomain& domain, const LogNormalPrior& prior, FitResult fit,
                                  std::uint64_t seed, int threads, int& evaluations) {
    std::vector<Eigen::VectorXd> from;
    LogNormalPrior drawn = prior;
    drawn.sd = prior.sd.cwiseMin(widest_start);
    for (int i = 0; i < starts && is_cheap(domain); ++i) {
        const Eigen::VectorXd z = RandomStream(seed, start_round, i).normals(domain.parameters().size());
        from.emplace_back(prior.mean + drawn.coloured(z).col(0));
    }
    return find_modes(domain, prior, std::move(fit), from, threads, evaluations);
}

std::vector<FitResult> find_modes(const PositionDomain& domain, const LogNormalPrior& prior, FitResult fit,
                                  const std::vector<Eigen::VectorXd>& from, int threads, int& evaluations) {
    std::vector<FitResult> modes{std::move(fit)};
    for (const Eigen::VectorXd& start : from) {
        std::optional<FitResult> mode = try_fit(domain, prior, start, threads);
        if (!mode) continue;
        evaluations += mode->evaluations;
        const auto is_same = [&](const FitResult& other) { return distance(*mode, other, prior) < same; };
        if (mode->converged && std::ranges::none_of(modes, is_same)) modes.push_back(std::move(*mode));
    }
    const auto height = [&](const FitResult& mode) { return -mode.chi_squared / 2 - prior.half_square(mode.theta); };
    std::ranges::stable_sort(modes, std::greater{}, height);
    const double least = height(modes.front()) - negligible;
    std::erase_if(modes, [&](const FitResult& mode) { return height(mode) < least; });
    return modes;
}

}  // namespace palpate::identify
