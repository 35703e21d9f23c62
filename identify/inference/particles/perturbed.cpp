#include "identify/inference/particles/perturbed.h"

#include "identify/numerics/conjugate_gradients.h"
#include "identify/numerics/random.h"

namespace palpate::identify {

PerturbedSteps perturbed_steps(const ErrorJacobian& jacobian, const LogNormalPrior& prior, const Spectrum& near,
                               int count, std::uint64_t seed) {
    const auto P = static_cast<int>(prior.mean.size());
    std::vector<Eigen::MatrixXd> e(static_cast<std::size_t>(jacobian.count_read()));
    for (int s = 0; s < jacobian.count_read(); ++s) e[s].resize(jacobian.weights(s).size(), count);
    Eigen::MatrixXd n(P, count);
    for (int i = 0; i < count; ++i) {
        RandomStream random(seed, 0, i);
        n.col(i) = random.normals(P);
        for (Eigen::MatrixXd& of_state : e) of_state.col(i) = random.normals(static_cast<int>(of_state.rows()));
    }
    const Eigen::MatrixXd right_hand_sides = prior.gradients_by_v(jacobian.transposed_times(e)) + n;
    const ShiftedSolution solution =
        solve_shifted(whitened_curvature(jacobian, prior), 1, right_hand_sides, near, {.left = 1e-3});
    return {solution.X, right_hand_sides - solution.left};
}

}  // namespace palpate::identify
