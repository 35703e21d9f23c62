// Slopes that chains follow, and the weights by the full law.

#include <gtest/gtest.h>

#include "identify/inference/maximum/fit_map.h"
#include "identify/inference/methods/full_law.h"
#include "identify/inference/particles/resampling.h"
#include "identify/numerics/random.h"
#include "tests/identify/domains.h"
#include "tests/identify/lattice.h"
#include "tests/skeleton/test_models.h"

namespace palpate::identify {
namespace {

using skeleton::EquilibriumLaw;

void expect_gradient(const PositionDomain& domain) {
    const int P = domain.parameters().size();
    const Eigen::VectorXd theta = 0.3 * RandomStream(4, 0, 0).normals(P);
    Eigen::VectorXd gradient;
    const double half = domain.half_chi_squared(theta, gradient);
    const Prediction prediction = domain.predict(theta, 1, nullptr, true);
    EXPECT_NEAR(half, domain.chi_squared(prediction) / 2, 1e-9 * half);
    const Eigen::VectorXd expected = domain.jacobian(theta, prediction).gradient();
    EXPECT_LT((gradient - expected).norm(), 1e-8 * expected.norm());
}

MeasurementSet pushed(const skeleton::Model& model) {
    return simulate_measurements(model, push_spheres(model, six_forces(1, 5)), markers_on_spheres(model), 0.05);
}

TEST(HalfChiSquared, GradientIsThatOfTheErrorsUnderBothLaws) {
    for (const EquilibriumLaw law : {EquilibriumLaw::linear, EquilibriumLaw::large_rotation}) {
        const skeleton::Model model = with_law(make_lattice({3, 2, 2}), law);
        expect_gradient(make_domain(model, Scope::links, pushed(model)));
    }
}

TEST(HalfChiSquared, GradientByVolumesAsWell) {
    const skeleton::Model model = with_law(skeleton::testing::make_full_lattice({3, 3, 2}), EquilibriumLaw::linear);
    ASSERT_TRUE(model.links.front().section.has_value());
    expect_gradient(make_domain(model, Scope::links, pushed(model)));
}

TEST(FullLaw, WeighsParticlesOfItsSurrogate) {
    const skeleton::Model model = with_law(make_lattice({4, 2, 1}), EquilibriumLaw::large_rotation);
    PositionDomain domain = make_domain(model, Scope::uniform, pushed(model));
    domain.set_model_error(0.02);
    const LogNormalPrior prior{Eigen::VectorXd::Zero(3), Eigen::VectorXd::Ones(3), nullptr};
    const FitResult fit = fit_map(domain, prior, prior.mean, 1);
    const PositionDomain surrogate = domain.linearised(fit.theta, fit.prediction);
    constexpr int N = 30;
    TemperedResult particles;
    particles.particles.resize(N, 3);
    for (int i = 0; i < N; ++i) particles.particles.row(i) = fit.theta + 0.02 * RandomStream(1, 0, i).normals(3);
    particles.log_weights = Eigen::VectorXd::Constant(N, -std::log(N));
    particles.log_density.setZero(N);
    particles.history.push_back({1, N, particles.particles, particles.log_weights});
    const double share = weigh_by_full_law(particles, domain, surrogate, fit, 1);

    Eigen::VectorXd expected(N);
    for (int i = 0; i < N; ++i) {
        const Eigen::VectorXd theta = particles.particles.row(i);
        expected[i] =
            (surrogate.chi_squared(surrogate.predict(theta, 1)) - domain.chi_squared(domain.predict(theta, 1))) / 2;
    }
    EXPECT_LT((particles.log_density - expected).cwiseAbs().maxCoeff(), 1e-6);  // equilibria to 1e-9
    normalise(expected);
    EXPECT_LT((particles.log_weights - expected).cwiseAbs().maxCoeff(), 1e-6);
    EXPECT_NEAR(share, effective_samples(expected) / N, 1e-6);
    EXPECT_EQ(particles.history.back().log_weights, particles.log_weights);
}

}  // namespace
}  // namespace palpate::identify
