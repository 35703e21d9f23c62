#include "identify/models/reference/reference_body.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/identify/small_body.h"

namespace palpate::identify {
namespace {

TEST(PressureInACavity, ActsAsTheSameEffectDoesAndOnNothingAsAWhole) {
    const SmallBody body = SmallBody::hollow();
    const auto model = body.reference();
    ASSERT_TRUE(model->has_cavities());
    for (const int law : {0, 1, 2}) {
        ModelSetting known = bare_truth(*model, law).setting(), effect = known;
        effect.effects.pressure = 0.01;
        const Action under_pressure{.contacts = {}, .pressure = 0.01};
        const Eigen::VectorXd q = model->equilibrium(known, under_pressure, nullptr);
        EXPECT_GT(q.norm(), 0.01);
        const Eigen::VectorXd forces = model->residual(q, known, under_pressure) - model->residual(q, known, {});
        const Eigen::VectorXd by_effect = model->residual(q, effect, {}) - model->residual(q, known, {});
        EXPECT_LT((forces - by_effect).norm(), 1e-12 * forces.norm());
        EXPECT_LT(forces.reshaped(3, forces.size() / 3).rowwise().sum().norm(), 1e-10 * forces.norm());  // rounding
    }
}

TEST(ReferenceBody, AStripOfOneElementInThicknessBendsAsABeamWithThinElements) {
    const mesh::VolumeMesh strip = mesh::to_quadratic(mesh::make_bar({0, 0, 0}, {60, 6, 1.5}, {20, 2, 1}));
    const auto compliance = [&](double poisson, fem::Dilatation dilatation) {
        const ReferenceBody body(strip, {mesh::BoxRegion{{-1, -1, -1}, {1e-6, 7, 3}}},
                                 {{1, Vec3(60, 3, 1.5), std::nullopt}},
                                 {.young = 1000.0, .poisson = poisson, .dilatation = dilatation});
        Explanation bare;
        bare.theta.resize(std::ssize(body.parameters()));
        for (Eigen::Index p = 0; p < bare.theta.size(); ++p) bare.theta[p] = body.parameters()[p].start;
        const auto height = [&](double force) {
            const Action action{.contacts = {{Vec3(60, 3, 1.5), Vec3(0, 0, force), 0.5}}};
            return body.observe(body.equilibrium(bare.setting(), action), bare.setting())(0, 2);
        };
        return (height(0.01) - height(-0.01)) / 0.02;
    };
    const double beam = std::pow(60, 3) / (3 * 1000 * 6 * std::pow(1.5, 3) / 12);  // L^3 / 3 E I
    for (const double poisson : {0.0, 0.33}) {
        // the clamp holds the width, which a beam does not
        EXPECT_NEAR(compliance(poisson, fem::Dilatation::thin), beam, 0.03 * beam) << poisson;
    }
    EXPECT_GT(compliance(0.33, fem::Dilatation::mean), 1.08 * beam);
}

}  // namespace
}  // namespace palpate::identify
