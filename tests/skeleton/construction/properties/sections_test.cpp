#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "skeleton/model/attachment/attach.h"
#include "skeleton/statics/equilibrium.h"
#include "tests/skeleton/construction/built_bodies.h"

namespace palpate::skeleton::built_bodies {

TEST(BuildSkeleton, LinksOfABarStandForItsSection) {
    const fem::Material material;
    const Model model = build(limb(), {.spheres = 12, .links = LinkKind::burion2008}).model;
    ASSERT_EQ(model.links.size(), 12u);
    for (const Link& link : model.links) {
        // Exact but for spheres that are 0.02 mm from the axis: a share of 1e-4, to first order.
        EXPECT_NEAR(link.stiffness(0) * link.length / material.young, 256, 1e-4 * 256);
        EXPECT_NEAR(link.stiffness(1) * link.length / (2 * material.young), 16. * 16 * 16 * 16 / 12, 1e-4 * 5461);
        EXPECT_NEAR(link.gyration, 16 / std::sqrt(12), 1e-4 * 16);
    }
}

TEST(BuildSkeleton, AnUncalibratedChainBendsLikeABeam) {
    const fem::Material material;
    const double length = 160, I = std::pow(16., 4) / 12;
    const double euler = 1e-3 * std::pow(length, 3) / (3 * material.young * I);
    // Chains of more than ten links are within 1 / 10^2 of the continuous beam.
    EXPECT_NEAR(sag(build(limb(), {.spheres = 14}).model, Vec3(160, 8, 8)) / euler, 1, 0.01);
    EXPECT_NEAR(sag(built_limb().model, Vec3(160, 8, 8)) / euler, 1, 0.01);
}

/// A thick limb's square end gets spheres of its own for its corners. Pushed at a corner, the end face stays a face:
/// its vertices lie within a fiftieth of the deflection round where the face's mean motion and turn put them.
TEST(BuildSkeleton, AnEndPushedAtItsCornerKeepsItsShape) {
    const Built built = build(block(Vec3(100, 30, 30), {20, 6, 6}), {.coverage = 3});
    ASSERT_GT(loops(built.model), 0) << "corners without spheres of their own test nothing";
    const fem::Material material;
    const double force = 2 * 3 * material.young * std::pow(30., 4) / 12 / std::pow(100., 3);  // [N], 2 mm by Euler
    Load load;
    load.forces.push_back({attach(built.model, Vec3(100, 30, 30)), Vec3(0, 0, -force)});
    const Equilibrium bent = equilibrium(built.model, load);

    std::vector<Attachment> end;
    for (const Attachment& vertex : built.model.skin) {
        if (vertex.rest.x() > 99.9) end.push_back(vertex);
    }
    Points rest(std::ssize(end), 3);
    for (std::size_t i = 0; i < end.size(); ++i) rest.row(static_cast<Eigen::Index>(i)) = end[i].rest;
    const Points moved = observe(built.model, bent, end);
    const Eigen::Matrix4d motion = Eigen::umeyama(rest.transpose().eval(), moved.transpose().eval(), false);
    const Points rigid =
        (rest * motion.topLeftCorner<3, 3>().transpose()).rowwise() + motion.topRightCorner<3, 1>().transpose();
    const double deflection = (moved - rest).rowwise().norm().mean();
    EXPECT_NEAR(deflection, 1.8, 0.1);  // what an uncalibrated skeleton makes of Euler's 2 mm
    EXPECT_LT((moved - rigid).rowwise().norm().maxCoeff(), 0.02 * deflection);
}

TEST(BuildSkeleton, AnUncalibratedLumpBendsLikeABeam) {
    const fem::Material material;
    const double area = 1600, I = area * area / 12;
    const double timoshenko =
        1e-3 * (std::pow(60., 3) / (3 * material.young * I) + 60 / (5. / 6 * material.shear_modulus() * area));
    const double ratio = sag(built_lump().model, Vec3(60, 20, 20)) / timoshenko;
    EXPECT_NEAR(ratio, 1, 0.05);  // a lump of 60 x 40 x 40 mm is hardly a beam: 0.96
}

TEST(BuildSkeleton, AnUncalibratedPlateBendsLikeAStrip) {
    const fem::Material material;
    const double euler = 1e-3 * std::pow(100., 3) / (3 * material.young * 80 * std::pow(6., 3) / 12);
    const double ratio = sag(built_plate().model, Vec3(100, 40, 3)) / euler;
    EXPECT_NEAR(ratio, 1.11, 0.03);  // the force acts at one point of the width
}

}  // namespace palpate::skeleton::built_bodies
