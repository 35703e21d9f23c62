#include "identify/particles/perturbed.h"

#include "identify/fit/conjugate_gradients.h"
#include "identify/particles/random.h"

namespace palpate::identify {

PerturbedSteps perturbed_steps(const Slopes& slopes, const LogNormalPrior& prior, const Spectrum& near, int count,
                               std::uint64_t seed) {
    const auto P = static_cast<int>(prior.mean.size());
    std::vector<Eigen::MatrixXd> e(static_cast<std::size_t>(slopes.count_read()));
    for (int s = 0; s < slopes.count_read(); ++s) e[s].resize(slopes.weights(s).size(), count);
    Eigen::MatrixXd n(P, count);
    for (int i = 0; i < count; ++i) {
        RandomStream random(seed, 0, i);
        n.col(i) = random.normals(P);
        for (Eigen::MatrixXd& of_state : e) of_state.col(i) = random.normals(static_cast<int>(of_state.rows()));
    }
    const Eigen::MatrixXd pulls = prior.slopes_by_v(slopes.transposed_times(e)) + n;
    const ShiftedSolution solution = solve_shifted(whitened_curvature(slopes, prior), 1, pulls, near, {.left = 1e-3});
    return {solution.X, pulls - solution.left};
}

}  // namespace palpate::identify
