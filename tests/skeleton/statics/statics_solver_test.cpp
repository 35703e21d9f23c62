#include <gtest/gtest.h>

#include <algorithm>

#include "skeleton/statics/equilibrium.h"
#include "skeleton/statics/statics.h"
#include "tests/skeleton/test_models.h"

namespace palpate::skeleton {
namespace {

using testing::at_sphere;
using testing::force_at;
using testing::make_lattice;
using testing::with_law;

TEST(StaticsSolver, AnswersAsTheFreeFunctionWhateverItSolvedBefore) {
    for (const EquilibriumLaw law : {EquilibriumLaw::linear, EquilibriumLaw::large_rotation}) {
        Model model = with_law(make_lattice({4, 2, 2}), law);
        StaticsSolver solver(model);
        const Eigen::VectorXd k = stiffness_vector(model);
        const Load load = force_at(model, 3, {1, 2, -3});
        solver.solve(3 * k, force_at(model, 5, {1, 0, 0}));
        EXPECT_EQ(solver.solve(k, load).step, equilibrium(model, load).step);
        const Equilibrium soft = solver.solve(0.5 * k, load);
        set_stiffness(model, 0.5 * k);
        EXPECT_EQ(soft.step, equilibrium(model, load).step);
    }
}

TEST(StaticsSolver, AnswersToTheLastBitWhicheverExpectedLoadComesFirst) {
    const Model model = with_law(make_lattice({12, 1, 1}), EquilibriumLaw::large_rotation);
    const auto between = [&](int a, int b, const Vec3& force) {
        Load load = force_at(model, a, force);
        load.forces.front().at.shares = {{.sphere = std::min(a, b), .weight = 0.5},
                                         {.sphere = std::max(a, b), .weight = 0.5}};
        return load;
    };
    const int last = static_cast<int>(model.spheres.size()) - 1;
    const std::vector<Load> loads = {between(last, 3, {0, 1e-3, -3e-3}), between(last, 6, {2e-3, 0, 1e-3}),
                                     between(last - 2, 2, {-1e-3, 2e-3, 0})};
    const Eigen::VectorXd k = stiffness_vector(model);
    std::vector<Eigen::VectorXd> found;
    for (std::size_t first = 0; first < loads.size(); ++first) {
        StaticsSolver solver(model);
        solver.expect(loads);
        solver.solve(k, loads[first]);
        found.push_back(solver.solve(k, loads[0]).step);
    }
    EXPECT_EQ(found[1], found[0]);
    EXPECT_EQ(found[2], found[0]);
}

TEST(StaticsSolver, LinearStepsSolveTheTangentAtRest) {
    const Model model = make_lattice({4, 3, 3});
    StaticsSolver solver(model);
    const Eigen::MatrixXd F = Eigen::MatrixXd::Random(model.dofs(), 20);
    const Eigen::MatrixXd U = solver.linear_steps(stiffness_vector(model), F);
    const Eigen::MatrixXd left = tangent(model, rest_state(model), {}) * U - F;
    for (int i = 0; i < static_cast<int>(model.spheres.size()); ++i) {
        if (model.spheres[i].held)
            EXPECT_EQ(U.middleRows<6>(6 * i).norm(), 0);
        else
            EXPECT_LT(left.middleRows<6>(6 * i).norm(), 1e-10);  // rounding, condition of some 1e4
    }
}

// d observe / d k = P J^-1 G, against differences of whole equilibria, for both laws.
TEST(StaticsSolver, TangentGivesTheSensitivityToStiffness) {
    for (const EquilibriumLaw law : {EquilibriumLaw::linear, EquilibriumLaw::large_rotation}) {
        const Model model = with_law(make_lattice({4, 2, 2}), law);
        StaticsSolver solver(model);
        const Eigen::VectorXd k = stiffness_vector(model);
        Load load = force_at(model, 3, {1, 2, -3});
        load.forces.push_back({between(model, 7, 11, 0.5, {33, 14, 8}), {0, 1, 1}});
        const std::vector<Attachment> points{at_sphere(model, 3), between(model, 10, 11, 0.3, {25, 12, 15})};

        const Equilibrium found = solver.solve(k, load, {1e-12});
        solver.factor_tangent(k, load, found);
        const Eigen::MatrixXd A = observation_jacobian(model, found, points) *
                                  solver.solve_tangent(Eigen::MatrixXd(link_forces(model, found)));
        for (const int e : {0, 4, 11, 30, 40, 47}) {
            const double h = 1e-4 * k[e];
            const Eigen::VectorXd change = h * Eigen::VectorXd::Unit(k.size(), e);
            const Points difference = observe(model, solver.solve(k + change, load, {1e-12}), points) -
                                      observe(model, solver.solve(k - change, load, {1e-12}), points);
            const Eigen::Map<const Eigen::VectorXd> flat(difference.data(), difference.size());
            // Relative h^2 = 1e-8; equilibria known to 1e-12 of 4 N, over h.
            EXPECT_LT((flat / (2 * h) - A.col(e)).norm(), 1e-6 * A.col(e).norm() + 1e-8) << law_names[int(law)] << e;
        }
    }
}

TEST(StaticsSolver, LeavesTheTangentOfItsAnswerFactored) {
    const Model model = make_lattice({4, 2, 2});
    StaticsSolver solver(model);
    const Load load = force_at(model, 3, {1, 2, -3});
    const Equilibrium found = solver.solve(stiffness_vector(model), load);
    const Eigen::VectorXd b = Eigen::VectorXd::LinSpaced(model.dofs(), -1, 1);
    const Eigen::VectorXd x = solver.solve_tangent(b);
    solver.factor_tangent(stiffness_vector(model), load, found);
    EXPECT_EQ(x, solver.solve_tangent(b));
}

TEST(StaticsSolver, ATangentFromNearbySavesNewtonSteps) {
    const Model model = make_lattice({4, 2, 2});
    const Load load = force_at(model, 3, {1, 2, -3});
    const Eigen::VectorXd k = stiffness_vector(model), softer = 0.95 * k;
    StaticsSolver near(model), solver(model);
    const Equilibrium start = near.solve(k, load);
    const Equilibrium alone = solver.solve(softer, load, {}, &start.state);
    const auto nearby = [&](const Eigen::MatrixXd& B) { return near.solve_tangent(B); };
    const Equilibrium guided = solver.solve(softer, load, {.nearby = nearby}, &start.state);
    EXPECT_GE(alone.iterations, 2);
    EXPECT_EQ(guided.iterations, 0);
    EXPECT_LT((guided.step - alone.step).norm(), 1e-9 * alone.step.norm());
    // and its tangent is factored there
    const Eigen::VectorXd b = Eigen::VectorXd::LinSpaced(model.dofs(), -1, 1), x = solver.solve_tangent(b);
    solver.factor_tangent(softer, load, guided);
    EXPECT_EQ(x, solver.solve_tangent(b));
}

TEST(StaticsSolver, ATangentThatIsNoneOfTheEquilibriumsDoesNoHarm) {
    const Model model = make_lattice({4, 2, 2});
    const Load load = force_at(model, 3, {1, 2, -3});
    const Eigen::VectorXd k = stiffness_vector(model);
    const Equilibrium alone = equilibrium(model, load);
    for (const double factor : {-1.0, 1e-6, 1e3}) {
        const auto wrong = [&](const Eigen::MatrixXd& B) -> Eigen::MatrixXd { return factor * B; };
        const Equilibrium found = StaticsSolver(model).solve(k, load, {.nearby = wrong});
        EXPECT_LT((found.step - alone.step).norm(), 1e-9 * alone.step.norm()) << factor;
    }
}

}  // namespace
}  // namespace palpate::skeleton
