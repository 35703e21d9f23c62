// Links and spheres of a body of several materials.

#include "skeleton/construction/properties/region_stiffness.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace palpate::skeleton {
namespace {

constexpr double length = 10, radius = 4;

/// A link along x between (0, 0, 0) and (10, 0, 0): a round beam of E = 1, mu = 0.4.
Model beam() {
    const double A = std::numbers::pi * radius * radius, I = A * radius * radius / 4, mu = 0.4;
    const double shear = 1 / (length / (5.0 / 6 * mu * A) + length * length * length / (12 * I));
    Model model;
    model.spheres.resize(2);
    model.spheres[1].center = Vec3(length, 0, 0);
    for (Sphere& sphere : model.spheres) sphere.radius = radius;
    Link link;
    link.a = 0;
    link.b = 1;
    link.length = length;
    link.stiffness = Stiffnesses(6);
    link.stiffness << A / length, I / length, 2 * mu * I / length, I / length, shear, shear;
    link.gyration = radius / 2;
    link.section = LinkSection{.at = Vec3(length / 2, 0, 0), .axes = Mat3::Identity(), .area = A};
    model.links.push_back(link);
    return model;
}

Eigen::VectorXd shares(const StiffnessField& field) {
    const Model before = beam();
    Model model = before;
    apply_field(field, model);
    return model.links[0].stiffness.cwiseQuotient(before.links[0].stiffness);
}

TEST(RegionStiffness, OfOneMaterialIsWhatItWas) {
    EXPECT_LT((shares([](const Vec3&) { return 1.0; }).array() - 1).abs().maxCoeff(), 1e-12);
    EXPECT_LT((shares([](const Vec3&) { return 7.0; }).array() - 7).abs().maxCoeff(), 1e-12);
}

TEST(RegionStiffness, OfABoneAlongALinkAddsToTheSection) {
    // Of half the radius: a quarter of the area, a sixteenth of the moments. Rings of the disc are coarser than that.
    const auto bone = [](const Vec3& x) { return x.tail<2>().norm() < radius * std::sqrt(0.4) ? 11.0 : 1.0; };
    const Eigen::VectorXd found = shares(bone);
    EXPECT_NEAR(found[0], 1 + 10 * 0.4, 1e-9);  // two rings of five, of equal area
    EXPECT_NEAR(found[1], 1 + 10 * 0.16, 1e-9);
    EXPECT_NEAR(found[2], 1 + 10 * 0.16, 1e-9);
    EXPECT_NEAR(found[3], found[1], 1e-9);
    // A short beam's shear is between that of the area and that of the moment.
    EXPECT_GT(found[4], found[1]);
    EXPECT_LT(found[4], found[0]);
}

TEST(RegionStiffness, OfAGapAcrossALinkAddsToItsSoftness) {
    const auto gap = [](const Vec3& x) { return x.x() > 5 ? 0.01 : 1.0; };
    const Eigen::VectorXd found = shares(gap);
    for (Eigen::Index k = 0; k < 6; ++k) EXPECT_NEAR(found[k], 1 / (0.5 + 0.5 * 100), 1e-9) << k;
}

TEST(RegionStiffness, BesideTheAxisMovesTheNeutralOne) {
    // The upper half ten times as stiff: about the middle the moment would be 5.5 times as large.
    const Eigen::VectorXd found = shares([](const Vec3& x) { return x.y() > 0 ? 10.0 : 1.0; });
    const double centroid = 4 * radius / (3 * std::numbers::pi), shift = (10 - 1) * centroid / (10 + 1);
    const double exact = 5.5 * (1 - shift * shift / (radius * radius / 4));
    // Five rings of the disc stand for it.
    EXPECT_NEAR(found[1], exact, 0.005 * exact);
    EXPECT_NEAR(found[3], 5.5, 0.015 * 5.5);
}

TEST(RegionStiffness, OfASphereIsThatOfItsSoftestPart) {
    Model model = beam();
    for (Sphere& sphere : model.spheres) sphere.volume = 3;
    apply_field([](const Vec3& x) { return x.x() > 5 ? 100.0 : 1.0; }, model);
    EXPECT_DOUBLE_EQ(model.spheres[0].volume, 3);
    EXPECT_GT(model.spheres[1].volume, 250);
}

TEST(RegionStiffness, LeavesThePapersLinksAsTheyAre) {
    Model model = beam();
    model.links[0].section.reset();
    model.links[0].stiffness = Vec3(1, 2, 3);
    apply_field([](const Vec3&) { return 5.0; }, model);
    EXPECT_EQ(Vec3(model.links[0].stiffness), Vec3(1, 2, 3));
}

}  // namespace
}  // namespace palpate::skeleton
