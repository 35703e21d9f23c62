#pragma once

#include <gtest/gtest.h>

#include "skeleton/statics/equilibrium.h"
#include "tests/skeleton/test_effects.h"

namespace palpate::skeleton::testing {

/// The tangent's sensitivity to stiffness after one load against central differences of equilibria after the same
/// history. Returns what the fibres had been through.
inline FibreStates expect_sensitivity_after_history(const fem::Effects& effects) {
    const Model model = make_lattice({4, 2, 2});
    StaticsSolver solver(model, effects);
    const Eigen::VectorXd k = stiffness_vector(model);
    const FibreStates before = flowed(model, solver.solve(k, force_at(model, 3, {2, 4, -6}), {1e-12}), effects);
    const Load load = force_at(model, 3, {1, 2, -3});
    const Equilibrium found = solver.solve(k, load, {1e-12}, nullptr, before);
    const Eigen::MatrixXd A = solver.solve_tangent(Eigen::MatrixXd(link_forces(model, found, effects)));
    for (const int e : {0, 4, 30}) {
        const double h = 1e-5 * k[e];
        const Eigen::VectorXd change = h * Eigen::VectorXd::Unit(k.size(), e);
        const Eigen::VectorXd difference = solver.solve(k + change, load, {1e-13}, nullptr, before).step -
                                           solver.solve(k - change, load, {1e-13}, nullptr, before).step;
        for (int i = 0; i < static_cast<int>(model.spheres.size()); ++i) {
            const Vec3 expected = difference.segment<3>(6 * i) / (2 * h);
            EXPECT_LT((expected - A.col(e).segment<3>(6 * i)).norm(), 1e-5 * A.col(e).norm() + 1e-7) << e;
        }
    }
    return before;
}

}  // namespace palpate::skeleton::testing
