// Effects in a part of the body: their shares, and what they come to on a body.

#include <gtest/gtest.h>

#include "fem/effects/local/local_force.h"
#include "fem/effects/local/local_springs.h"
#include "fem/effects/registry.h"
#include "mesh/errors.h"

namespace palpate::fem {
namespace {

Points line(int count) {
    Points points = Points::Zero(count, 3);
    for (int i = 0; i < count; ++i) points(i, 0) = i;
    return points;
}

TEST(Locality, SharesAddUpAndFallOffAsAGaussianDoes) {
    const Locality where{Vec3(2, 0, 0), 1.5};
    const Eigen::VectorXd even = Eigen::VectorXd::LinSpaced(9, 1, 3);
    const Eigen::VectorXd shares = where.shares(line(9), even);
    EXPECT_NEAR(shares.sum(), 1, 1e-15);
    EXPECT_NEAR((shares[4] / even[4]) / (shares[2] / even[2]), std::exp(-0.5 * 4 / 2.25), 1e-14);
}

TEST(Locality, FarFromAllPointsTheNearestHasItAll) {
    const Eigen::VectorXd shares = Locality{Vec3(100, 0, 0), 0.1}.shares(line(4), Eigen::VectorXd::Ones(4));
    EXPECT_NEAR((shares - Eigen::Vector4d(0, 0, 0, 1)).norm(), 0, 1e-15);
}

TEST(LocalForce, IsTheForceInAllHoweverTheBodyMoves) {
    const Vec3 F(0.1, -0.2, 0.3);
    const LocalForce force({Vec3(1, 0, 0), 2}, F);
    const Points rest = line(5);
    const Eigen::VectorXd weights = force.weights(rest, Eigen::VectorXd::Ones(5));
    Vec3 sum = Vec3::Zero();
    double work = 0;
    for (int i = 0; i < 5; ++i) {
        const Vec3 X = rest.row(i), x = X + Vec3(0.5, -0.1 * i, 2);
        const PointTerms terms = force.terms(X, x);
        sum -= weights[i] * terms.gradient;
        work -= weights[i] * (terms.energy - F.dot(X - x));
        EXPECT_EQ(terms.hessian, Mat3::Zero());
    }
    EXPECT_LT((sum - F).norm(), 1e-15);
    EXPECT_NEAR(work, 0, 1e-15);
}

TEST(LocalSprings, PullAPartThatMovesBackByTheStiffnessInAll) {
    const LocalSprings springs({Vec3(1, 0, 0), 2}, 0.7);
    EXPECT_EQ(springs.acts_on(), ActsOn::surface);
    const Points rest = line(5);
    const Eigen::VectorXd weights = springs.weights(rest, Eigen::VectorXd::Constant(5, 3));
    const Vec3 moved(0.2, 0, -0.1);
    Vec3 sum = Vec3::Zero();
    double energy = 0;
    for (int i = 0; i < 5; ++i) {
        const Vec3 X = rest.row(i);
        const PointTerms terms = springs.terms(X, X + moved);
        sum -= weights[i] * terms.gradient;
        energy += weights[i] * terms.energy;
    }
    EXPECT_LT((sum + 0.7 * moved).norm(), 1e-15);
    EXPECT_NEAR(energy, 0.5 * 0.7 * moved.squaredNorm(), 1e-15);
}

TEST(Growth, OfPartsAddsUp) {
    Growth growth{.everywhere = 0.1, .parts = {{{Vec3(2, 0, 0), 2}, -0.3}}};
    EXPECT_DOUBLE_EQ(growth.at({2, 0, 2}), 0.1 - 0.3 * std::exp(-0.5));
    growth.add({.everywhere = 0.05, .parts = {{{Vec3(0, 0, 0), 1}, 0.2}}});
    EXPECT_NEAR(growth.at({2, 0, 0}), 0.15 - 0.3 + 0.2 * std::exp(-2), 1e-15);
    EXPECT_TRUE(growth.possible());
    EXPECT_THROW(growth.add({.parts = {{{Vec3(50, 0, 0), 1}, -0.9}}}), InvalidInput);
}

TEST(Growth, MeanAlongALineIsThatOfTheGaussian) {
    const Growth growth{.parts = {{{Vec3(1, 0, 0), 2}, 0.2}}};
    const double integral = 2 * std::sqrt(M_PI / 2) * (std::erf(4 / std::sqrt(8.0)) + std::erf(1 / std::sqrt(8.0)));
    EXPECT_NEAR(growth.between({0, 0, 0}, {5, 0, 0}), 0.2 * integral / 5, 3e-4);  // h^2 / 24 of the slopes at its ends
    EXPECT_DOUBLE_EQ(growth.between({1, 0, 0}, {1, 0, 0}), 0.2);
}

TEST(LocalEffects, AreKnownByTheirNumbers) {
    const std::vector<EffectParameter> place{{"cx", 1, "mm"}, {"cy", 2, "mm"}, {"cz", 3, "mm"}, {"radius", 4, "mm"}};
    EffectRecord force{"local-force", place}, springs{"local-springs", place};
    for (const char* name : {"fx", "fy", "fz"}) force.parameters.push_back({name, 0.5, "N"});
    springs.parameters.push_back({"stiffness", 0.2, "N/mm"});
    const EffectRegistry& known = EffectRegistry::instance();
    EXPECT_EQ(known.make(force).points.front()->terms(Vec3::Zero(), Vec3::Zero()).gradient, Vec3::Constant(-0.5));
    EXPECT_EQ(known.make(springs).points.front()->terms(Vec3::Zero(), Vec3(1, 0, 0)).gradient, Vec3(0.2, 0, 0));
    springs.parameters[3].value = 0;
    EXPECT_THROW(known.make(springs), InvalidInput);
    EffectRecord swelling{"local-swelling", place};
    swelling.parameters.push_back({"growth", -0.5, "1"});
    EXPECT_EQ(known.make(swelling).growth.at({1, 2, 3}), -0.5);
    swelling.parameters.back().value = -1;
    EXPECT_THROW(known.make(swelling), InvalidInput);
}

}  // namespace
}  // namespace palpate::fem
