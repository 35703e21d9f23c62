#include "skeleton/links/sections/section_law.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <Eigen/LU>

#include "fem/effects/material/anisotropy.h"
#include "fem/effects/material/inclusion.h"
#include "fem/effects/material/stiffening.h"
#include "skeleton/statics/equilibrium.h"
#include "tests/skeleton/test_models.h"

namespace palpate::skeleton {
namespace {

using Mat6 = Eigen::Matrix<double, 6, 6>;

constexpr int elongation = 0, flexion = 1, torsion = 2, flexion_2 = 3, shear = 4, shear_2 = 5;
constexpr double mu = 0.1, young = 2 * (1 + 0.49) * mu;  // [MPa]; nearly incompressible, as the laws take it
constexpr double wide = 12, thick = 6, spacing = 8;      // of the bar [mm]

/// A bar along x as a chain of full links, wide along y and thick along z, with the stiffnesses of its section; its
/// first sphere is held.
Model make_bar_chain(int links) {
    Model model;
    for (int i = 0; i <= links; ++i) model.spheres.push_back(testing::sphere_at({spacing * i, 0, 0}, i == 0));
    const double A = wide * thick, I_1 = A * wide * wide / 12, I_2 = A * thick * thick / 12, L = spacing;
    for (int i = 0; i < links; ++i) {
        Link link;
        link.a = i;
        link.b = i + 1;
        link.length = L;
        const double bent = L * L * L / (12 * young), sheared = L / (5.0 / 6 * mu * A);
        link.stiffness.resize(6);
        link.stiffness << young * A / L, young * I_1 / L, 4 * mu * I_1 * I_2 / (I_1 + I_2) / L, young * I_2 / L,
            1 / (sheared + bent / I_1), 1 / (sheared + bent / I_2);
        link.gyration = std::sqrt(wide * thick / 12);
        link.section = LinkSection{Vec3(L * (i + 0.5), 0, 0), Mat3::Identity(), A};
        model.links.push_back(link);
    }
    return model;
}

fem::Effects fibres_along(double k, const Vec3& n) {
    return {.material = {std::make_shared<fem::Anisotropy>(std::vector<fem::Fibre>{{k, n}})}};
}
fem::Effects lump(const Vec3& centre, double radius, double ratio) {
    return {.material = {std::make_shared<fem::Inclusion>(fem::Inclusion::sphere(centre, radius, ratio))}};
}

/// C^T diag(k m) C of a link.
Mat6 stiffness_of(const Model& model, std::size_t link, const SectionLaw& law) {
    const Eigen::Matrix<double, 6, 1> k = model.links[link].stiffness.cwiseProduct(law.factors);
    return law.coupling.transpose() * k.asDiagonal() * law.coupling;
}

TEST(SectionLaw, NoneWithoutWhatActsInSections) {
    const Model bar = make_bar_chain(2);
    EXPECT_TRUE(section_laws(bar, {}).empty());
    // a law that is the plain one at rest is the fibres'
    EXPECT_TRUE(section_laws(bar, {.material = {std::make_shared<fem::Stiffening>(3, 30)}}).empty());
    EXPECT_TRUE(section_laws(testing::make_chain(2), fibres_along(2, Vec3::UnitX())).empty())
        << "paper's links have no section";
}

TEST(SectionLaw, NoneOfALumpsLinks) {
    Model bar = make_bar_chain(2);
    bar.spheres[2].cell = 500;
    bar.spheres[2].volume = 0.3;
    const std::vector<SectionLaw> laws = section_laws(bar, fibres_along(2, Vec3::UnitX()));
    ASSERT_EQ(laws.size(), 2u);
    EXPECT_TRUE(laws[0].in_force);
    EXPECT_FALSE(laws[1].in_force);
}

TEST(SectionLaw, WhatScalesAllScalesAStiffness) {
    const std::vector<SectionLaw> laws = section_laws(make_bar_chain(2), lump({8, 0, 0}, 1000, 3));
    for (const SectionLaw& law : laws) {
        EXPECT_LT((law.factors.array() - 3).abs().maxCoeff(), 1e-9);
        EXPECT_LT((law.coupling - Mat6::Identity()).cwiseAbs().maxCoeff(), 1e-9);
    }
}

TEST(SectionLaw, FibresAlongABarAddTheirModulusToItsOwn) {
    constexpr double k = 2;
    const SectionLaw law = section_laws(make_bar_chain(1), fibres_along(k, Vec3::UnitX())).front();
    for (const int s : {elongation, flexion, flexion_2}) EXPECT_NEAR(law.factors[s], 1 + k * mu / young, 1e-9) << s;
    EXPECT_NEAR(law.factors[torsion], 1, 1e-9);
    // What bends under shear is stiffer, what shears is not.
    for (const int s : {shear, shear_2}) {
        EXPECT_GT(law.factors[s], 1.01) << s;
        EXPECT_LT(law.factors[s], 1 + k * mu / young) << s;
    }
    EXPECT_LT((law.coupling - Mat6::Identity()).cwiseAbs().maxCoeff(), 1e-9);
}

TEST(SectionLaw, FibresAtAnAngleTurnWhatIsBentAndShearWhatIsPulled) {
    const Model bar = make_bar_chain(1);
    const Mat6 there = stiffness_of(bar, 0, section_laws(bar, fibres_along(4, {1, 1, 0})).front());
    const Mat6 mirrored = stiffness_of(bar, 0, section_laws(bar, fibres_along(4, {1, -1, 0})).front());
    const auto coupling = [](const Mat6& K, int i, int j) { return K(i, j) / std::sqrt(K(i, i) * K(j, j)); };
    EXPECT_GT(coupling(there, elongation, shear), 0.1);
    EXPECT_LT(coupling(there, torsion, flexion_2), -0.05);  // out of the fibres' plane
    // Fibres mirrored in the plane of the other shear: what is odd under it changes its sign, all else stays.
    for (int i = 0; i < 6; ++i)
        for (int j = 0; j < 6; ++j) {
            const bool odd_i = i == shear || i == torsion || i == flexion,
                       odd_j = j == shear || j == torsion || j == flexion;
            EXPECT_NEAR(mirrored(i, j), (odd_i == odd_j ? 1 : -1) * there(i, j), 1e-9 * there(1, 1)) << i << j;
        }
}

TEST(SectionLaw, ALumpBesideTheAxisBendsWhatIsPulled) {
    const Model bar = make_bar_chain(1);
    // Stiff where y > 2: what is pulled bends away from it, about z.
    const SectionLaw law = section_laws(bar, lump({4, 6, 0}, 4, 8)).front();
    const Mat6 K = stiffness_of(bar, 0, law), F = K.inverse();
    EXPECT_LT(K(elongation, flexion), 0);
    EXPECT_GT(F(elongation, flexion), 0.05 * std::sqrt(F(0, 0) * F(1, 1)));
    EXPECT_LT(std::abs(K(elongation, flexion_2)), 1e-3 * std::sqrt(K(0, 0) * K(3, 3))) << "symmetric across";
    // Nothing is softer than without, nor 8 times as stiff.
    const Mat6 plain = Mat6(bar.links.front().stiffness.asDiagonal());
    EXPECT_GT(Eigen::SelfAdjointEigenSolver<Mat6>(K - plain).eigenvalues().minCoeff(), -1e-9 * K(1, 1));
    EXPECT_GT(Eigen::SelfAdjointEigenSolver<Mat6>(8 * plain - K).eigenvalues().minCoeff(), -1e-9 * K(1, 1));
}

TEST(SectionLaw, TurnsWithTheBody) {
    const Model bar = make_bar_chain(1);
    const Vec3 n(1, 0.7, -0.4), centre(3, 4, 1);
    const Mat3 R = Eigen::AngleAxisd(1.1, Vec3(0.2, -1, 0.5).normalized()).toRotationMatrix();
    Model turned = bar;
    for (Sphere& sphere : turned.spheres) sphere.center = R * sphere.center;
    turned.links.front().section->at = R * bar.links.front().section->at;
    turned.links.front().section->axes = bar.links.front().section->axes * R.transpose();
    const auto both = [](const fem::Effects& a, const fem::Effects& b) {
        return fem::Effects{.material = {a.material.front(), b.material.front()}};
    };
    const SectionLaw law = section_laws(bar, both(fibres_along(3, n), lump(centre, 4, 5))).front();
    const SectionLaw then = section_laws(turned, both(fibres_along(3, R * n), lump(R * centre, 4, 5))).front();
    EXPECT_LT((law.factors - then.factors).cwiseAbs().maxCoeff(), 1e-9);
    EXPECT_LT((law.coupling - then.coupling).cwiseAbs().maxCoeff(), 1e-9);
    EXPECT_GT(law.factors.minCoeff(), 0);
    EXPECT_TRUE(law.coupling.isUpperTriangular(0));
}

TEST(SectionLaw, IsTheSameHoweverStiffTheLinkIs) {
    // Couplings are geometry, so that a fit of the stiffnesses is linear in them.
    Model bar = make_bar_chain(1);
    const SectionLaw before = section_laws(bar, fibres_along(4, {1, 1, 0})).front();
    bar.links.front().stiffness.array() *= Eigen::Array<double, 6, 1>(2, 0.5, 3, 0.5, 0.7, 0.7);
    const SectionLaw after = section_laws(bar, fibres_along(4, {1, 1, 0})).front();
    EXPECT_EQ(before.factors, after.factors);
    EXPECT_EQ(before.coupling, after.coupling);
}

TEST(SectionLaw, LimbsAndPlatesTellTheirSectionsEachInTheirWay) {
    // A limb's radius of gyration is that of the mean of its moments, a plate's that of the smaller.
    Model bar = make_bar_chain(1);
    const SectionLaw limb = section_laws(bar, fibres_along(4, {1, 1, 0})).front();
    bar.links.front().gyration = thick / std::sqrt(12.0);
    const SectionLaw plate = section_laws(bar, fibres_along(4, {1, 1, 0})).front();
    EXPECT_LT((limb.factors - plate.factors).cwiseAbs().maxCoeff(), 1e-9);
    EXPECT_LT((limb.coupling - plate.coupling).cwiseAbs().maxCoeff(), 1e-9);
}

// The equilibrium of a long bar whose end is loaded, against the beam that the laws are made of.
TEST(SectionLaw, AChainOfTwiceAsManyLinksBendsAlike) {
    // Finer chains are the same beam: place and turn of the end, loaded by a force and couple, agree.
    const auto end_of = [](int links) {
        Model bar = make_bar_chain(links);
        const double shrink = 8.0 / links;
        for (Sphere& sphere : bar.spheres) sphere.center *= shrink;
        for (Link& link : bar.links) {
            const double L = link.length *= shrink, A = wide * thick;
            link.section->at *= shrink;
            const double bent = L * L * L / (12 * young), sheared = L / (5.0 / 6 * mu * A);
            link.stiffness.head<4>() /= shrink;
            link.stiffness.tail<2>() << 1 / (sheared + bent / (A * wide * wide / 12)),
                1 / (sheared + bent / (A * thick * thick / 12));
        }
        bar.law = EquilibriumLaw::linear;
        bar.effects = {{"anisotropy", {{"k", 4, "1"}, {"nx", 1, "1"}, {"ny", 1, "1"}, {"nz", 0.5, "1"}}}};
        const Equilibrium found = equilibrium(bar, testing::force_at(bar, links, {0.01, 0.002, 0.003}));
        return Eigen::Matrix<double, 6, 1>(found.step.tail<6>());
    };
    const Eigen::Matrix<double, 6, 1> coarse = end_of(8), fine = end_of(16);
    EXPECT_LT((coarse - fine).norm(), 1e-6 * fine.norm());
    EXPECT_GT(std::abs(fine[3]), 0.01 * fine.tail<3>().norm()) << "it turns about itself";
}

}  // namespace
}  // namespace palpate::skeleton
