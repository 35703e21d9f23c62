// Draws by perturbed fits, and what they rest on: equations with a shift, transposed products, what a step promises.

#include "identify/inference/particles/perturbed.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>

#include "identify/inference/particles/drawn.h"
#include "identify/numerics/conjugate_gradients.h"
#include "identify/numerics/random.h"
#include "tests/identify/domains.h"
#include "tests/identify/lattice.h"

namespace palpate::identify {
namespace {

using skeleton::EquilibriumLaw;

Eigen::MatrixXd columns(int P, int count, int key) {
    Eigen::MatrixXd X(P, count);
    for (int i = 0; i < count; ++i) X.col(i) = RandomStream(key, 0, i).normals(P);
    return X;
}

TEST(SolveShifted, SolvesColumnsSideBySide) {
    constexpr int P = 30;
    const Eigen::MatrixXd R = columns(P, 50, 1), A = R * R.transpose();
    const SymmetricProduct times = [&](const Eigen::MatrixXd& V) { return A * V; };
    Eigen::MatrixXd B = columns(P, 4, 2);
    B.col(2).setZero();  // solved from the start
    const ShiftedSolution found = solve_shifted(times, 0.5, B, {}, {.left = 1e-20});
    const Eigen::MatrixXd exact = (A + 0.5 * Eigen::MatrixXd::Identity(P, P)).llt().solve(B);
    EXPECT_LT((found.X - exact).norm(), 1e-8 * exact.norm());
    EXPECT_EQ(found.X.col(2), Eigen::VectorXd::Zero(P));
    EXPECT_LE(found.products, 2 * P);  // P of them by exact arithmetic
    // what is left is told, however early it ends
    const ShiftedSolution early = solve_shifted(times, 0.5, B, {}, {.left = 1e-20, .products = 3});
    EXPECT_EQ(early.products, 3);
    EXPECT_LT((B - A * early.X - 0.5 * early.X - early.left).norm(), 1e-9 * B.norm());
    // the spectrum of A itself leaves nothing to do
    EXPECT_EQ(solve_shifted(times, 0.5, B, leading_spectrum(times, P)).products, 1);
}

TEST(SolveShifted, ColumnsShareTheirDirections) {
    constexpr int P = 400, together = 16;
    const Eigen::MatrixXd R =
        columns(P, P, 1) * Eigen::VectorXd::LinSpaced(P, 0, 8).array().exp().inverse().matrix().asDiagonal();
    const Eigen::MatrixXd A = 100 * R * R.transpose();  // eigenvalues over seven orders of magnitude
    const SymmetricProduct times = [&](const Eigen::MatrixXd& V) { return A * V; };
    Eigen::MatrixXd B = columns(P, together, 2);
    B.col(1) = 1e-6 * B.col(0);  // no direction of its own
    const ShiftedSolution all = solve_shifted(times, 1, B, {}), one = solve_shifted(times, 1, B.col(0), {});
    const Eigen::MatrixXd exact = (A + Eigen::MatrixXd::Identity(P, P)).llt().solve(B);
    EXPECT_LT(3 * all.products, one.products);

    // each to the energy that may be left, but for what the last products do not tell
    const auto left = [&](const ShiftedSolution& found, int column) {
        const Eigen::VectorXd off = exact.col(column) - found.X.col(column);
        return off.dot(A * off + off) / B.col(column).dot(exact.col(column));
    };
    for (int i = 0; i < together; ++i) EXPECT_LT(left(all, i), 3e-6) << i;
    EXPECT_LT(left(one, 0), 3e-6);

    const double energy = B.col(0).dot(exact.col(0));
    const ShiftedSolution early = solve_shifted(times, 1, B.col(0), {}, {.enough = 0.1 * energy});
    EXPECT_LT(early.products, one.products);
    EXPECT_LT(left(early, 0), 0.1);
}

/// A block whose links differ, seen at its spheres.
struct FittedBody {
    skeleton::Model model;
    MeasurementSet set;
    PositionDomain domain;
    LogNormalPrior prior;
    FitResult fit;

    explicit FittedBody(EquilibriumLaw law)
        : model(with_law(make_lattice({3, 2, 2}), law)),
          set(measured()),
          domain(make_domain(model, Scope::links, set)) {
        domain.set_model_error(0.05);
        const int P = domain.parameters().size();
        prior = {Eigen::VectorXd::Zero(P), Eigen::VectorXd::Constant(P, 0.7), nullptr};
        fit = fit_map(domain, prior, prior.mean, 1);
    }
    MeasurementSet measured() const {
        skeleton::Model truth = model;
        for (std::size_t l = 0; l < truth.links.size(); ++l) {
            truth.links[l].stiffness.head<3>().array() *= (0.3 * RandomStream(3, 0, l).normals(3)).array().exp();
        }
        return simulate_measurements(truth, push_spheres(truth, six_forces(1, 5)), markers_on_spheres(truth), 0.05);
    }
    ErrorJacobian jacobian() const { return domain.jacobian(fit.theta, domain.predict(fit.theta, 1)); }
};

class OfBothLaws : public testing::TestWithParam<EquilibriumLaw> {};
INSTANTIATE_TEST_SUITE_P(Perturbed, OfBothLaws,
                         testing::Values(EquilibriumLaw::linear, EquilibriumLaw::large_rotation));

TEST_P(OfBothLaws, TransposedProductsGoWithTheOthers) {
    const FittedBody body(GetParam());
    const ErrorJacobian jacobian = body.jacobian();
    const Eigen::MatrixXd V = columns(body.domain.parameters().size(), 3, 5);
    std::vector<Eigen::MatrixXd> D;  // -J V
    for (int s = 0; s < jacobian.count_read(); ++s) {
        D.emplace_back(jacobian.weights(s).cwiseSqrt().asDiagonal() * jacobian.moved_markers(s, V));
    }
    const Eigen::MatrixXd curvature = jacobian.curvature_times(V);
    EXPECT_LT((jacobian.transposed_times(D) + curvature).norm(), 1e-10 * curvature.norm());  // rounding
}

TEST_P(OfBothLaws, StepsAreAsWideAsThePosterior) {
    const FittedBody body(GetParam());
    const ErrorJacobian jacobian = body.jacobian();
    const auto P = static_cast<int>(body.prior.mean.size());
    const SymmetricProduct A = whitened_curvature(jacobian, body.prior);
    const Eigen::MatrixXd precision = A(Eigen::MatrixXd::Identity(P, P)) + Eigen::MatrixXd::Identity(P, P);
    const Eigen::MatrixXd covariance = precision.llt().solve(Eigen::MatrixXd::Identity(P, P));
    constexpr int N = 3000;
    // a spectrum that holds a few of the directions, as it must where there are too many
    Spectrum few = body.fit.spectrum;
    few.values = few.values.head(5).eval();
    few.vectors = few.vectors.leftCols(5).eval();
    const PerturbedSteps steps = perturbed_steps(jacobian, body.prior, few, N, 1);
    EXPECT_LT((steps.right_hand_sides - precision * steps.v).norm(), 1e-9 * steps.right_hand_sides.norm());
    const Eigen::MatrixXd of_steps = steps.v * steps.v.transpose() / N;
    double narrowest = 1;
    for (int p = 0; p < P; ++p) {
        // five sigma of a variance, and what is left of the equations
        EXPECT_NEAR(of_steps(p, p) / covariance(p, p), 1, 5 * std::sqrt(2.0 / N) + 0.05) << p;
        narrowest = std::min(narrowest, covariance(p, p));
    }
    EXPECT_LT(narrowest, 0.3);                                           // the readings tell something
    EXPECT_LT((of_steps - covariance).norm() / covariance.norm(), 0.2);  // sqrt(P / N) and more
}

TEST_P(OfBothLaws, APromiseOfTheLinearLawIsKept) {
    const FittedBody body(GetParam());
    PositionDomain sharper = body.domain;
    sharper.set_model_error(1e-6);
    const FitResult found = fit_map(sharper, body.prior, body.fit.theta, 1);
    const double before = sharper.chi_squared(body.fit.prediction), after = found.chi_squared;
    const double promised = promised_chi_squared(sharper, body.prior, body.fit, 10);
    EXPECT_GT(before, 1.1 * after);  // there is something to promise
    // multipliers go by logarithms: not straight, but nearly so
    EXPECT_NEAR(promised, after, 0.02 * (before - after));
}

TEST(PerturbedParticles, MixturesOfFewDrawsAreAsWide) {
    const FittedBody body(EquilibriumLaw::linear);
    const auto P = static_cast<int>(body.prior.mean.size());
    const GaussianProposal proposal = laplace_proposal(body.fit, body.prior);
    const PerturbedSteps steps = perturbed_steps(body.jacobian(), body.prior, body.fit.spectrum, 40, 1);
    const LogDensity density = [&](const Eigen::VectorXd& theta) {
        return -body.domain.chi_squared(body.domain.predict(theta, 1)) / 2 - body.prior.half_square(theta);
    };
    const TemperedResult drawn = perturbed_particles(density, body.fit.theta, steps, proposal, {.particles = 2000});
    EXPECT_EQ(drawn.independent, 40);
    EXPECT_FALSE(drawn.weighed);
    const Eigen::MatrixXd off = drawn.particles.rowwise() - body.fit.theta.transpose();
    const Eigen::MatrixXd theta_steps = body.prior.coloured(steps.v);
    for (int p = 0; p < P; ++p) {
        const double variance = off.col(p).squaredNorm() / 2000;
        EXPECT_NEAR(variance / (theta_steps.row(p).squaredNorm() / 40), 1, 5 * std::sqrt(2.0 / 2000)) << p;
    }
    // the density beside the mean's goes by half a square
    const double at_mean = density(body.fit.theta);
    for (const int i : {0, 7, 1999}) {
        const double actual = density(drawn.particles.row(i));
        EXPECT_NEAR(drawn.log_density[i], actual, 0.5 * std::abs(at_mean - actual)) << i;
    }
    // as many particles as draws are the draws
    EXPECT_EQ(perturbed_particles(density, body.fit.theta, steps, proposal, {.particles = 40}).independent, 40);
    EXPECT_EQ(independent_draws(20, 200), 200);
    EXPECT_EQ(independent_draws(20000, 200), 24);
    EXPECT_EQ(independent_draws(20000, 10), 10);
}

}  // namespace
}  // namespace palpate::identify
