#include "fem/large_deformation/solve/tangent_solver.h"

#include "fem/elements/assembly.h"
#include "tests/fem/large_deformation/solve/iterated.h"
#include "tests/messages.h"

namespace palpate::fem {
namespace {

TEST(TangentSolver, MultigridFindsWhatAFactorFinds) { expect_as_by_a_factor(Solver::multigrid, iterated_cases()); }

TEST(TangentSolver, AMatrixThatIsNotPositiveDefiniteIsTold) {
    const Beam beam({4, 1, 1}, {8, 2, 2});
    for (const Solver solver : {Solver::factor, Solver::multigrid}) {
        const EliminationOrder order = elimination_order(beam.mesh, beam.held, {}, solver);
        EXPECT_EQ(order.solver, solver);
        LowerMatrix K = assemble<std::int64_t>(beam.mesh, {}, Dilatation::mean, order.unknowns.number(), Half::lower);
        const auto own = make_tangent_solver(order, Accuracy::steps);
        EXPECT_TRUE(own->take(K));
        EXPECT_GT(own->gigabytes(), 8e-9 * static_cast<double>(K.nonZeros()));
        K *= -1;
        EXPECT_FALSE(own->take(K));
    }
}

TEST(TangentSolver, OnADirectionOfNegativeCurvatureAStepStillLeadsDown) {
    // Indefinite by its softest mode alone, of which no level's factor says so.
    const Beam beam({4, 1, 1}, {8, 2, 2});
    const EliminationOrder order = elimination_order(beam.mesh, beam.held, {}, Solver::multigrid);
    LowerMatrix K = assemble<std::int64_t>(beam.mesh, {}, Dilatation::mean, order.unknowns.number(), Half::lower);
    const Eigen::VectorXd eigenvalues = Eigen::MatrixXd(K).selfadjointView<Eigen::Lower>().eigenvalues();
    for (Eigen::Index k = 0; k < K.cols(); ++k) K.coeffRef(k, k) -= 1.5 * eigenvalues.minCoeff();
    const auto own = make_tangent_solver(order, Accuracy::steps);
    MultiVector r = MultiVector::Ones(K.cols(), 2), X = r;
    ASSERT_TRUE(own->take(K));
    own->solve(X);
    for (int j = 0; j < 2; ++j) EXPECT_GT(X.col(j).dot(r.col(j)), 0);
}

}  // namespace
}  // namespace palpate::fem
