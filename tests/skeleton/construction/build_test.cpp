#include "skeleton/construction/build.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <string>

#include "mesh/errors.h"
#include "mesh/geometry/surface_tree.h"
#include "tests/skeleton/construction/built_bodies.h"

namespace palpate::skeleton::built_bodies {

TEST(BuildSkeleton, IsOnePieceInsideTheBodyWithSoundLinks) {
    for (const Built& built : {built_limb(), built_plate(), built_lump()}) {
        const mesh::SurfaceTree tree(built.surface);
        EXPECT_EQ(components(built.model), 1);
        for (const Sphere& s : built.model.spheres) {
            EXPECT_GT(s.radius, 0);
            EXPECT_GT(s.mass, 0);
            // Held spheres stand on the held face itself.
            if (s.held) {
                EXPECT_LT(tree.closest(s.center).distance, 1e-6);
            } else {
                EXPECT_TRUE(tree.inside(s.center));
            }
        }
        for (const Link& link : built.model.links) {
            EXPECT_LT(link.a, link.b);
            EXPECT_FALSE(built.model.spheres[link.a].held && built.model.spheres[link.b].held);
            EXPECT_GT(link.stiffness.minCoeff(), 0);
            EXPECT_NEAR(link.length, (built.model.spheres[link.b].center - built.model.spheres[link.a].center).norm(),
                        1e-9);
            EXPECT_GT(link.length, 0.5);
        }
        EXPECT_EQ(built.model.skin.size(), static_cast<std::size_t>(built.surface.vertices.rows()));
    }
}

TEST(BuildSkeleton, ALimbIsAChainAPlateALayerALumpIsFilled) {
    // Fifteen or so along a limb; the extra ones cover the edges of its end.
    const Built chain = build(limb(), {.spheres = 15});
    EXPECT_EQ(loops(chain.model), 0);
    for (const Sphere& s : chain.model.spheres) {
        // On the axis, by symmetry; jagged cells leave 0.02 mm of 8.
        EXPECT_LT((s.center - Vec3(s.center.x(), 8, 8)).norm(), 0.03);
    }
    EXPECT_GE(free_spheres(built_limb().model), 10);
    EXPECT_LE(free_spheres(built_limb().model), 30);

    const Built& layer = built_plate();
    EXPECT_NEAR(free_spheres(layer.model), 60, 3);  // a tie that rounding decides takes or gives a few
    for (const Sphere& s : layer.model.spheres) EXPECT_NEAR(s.center.z(), 3, 0.15);  // jagged cells leave 0.12 mm

    const Built& filled = built_lump();
    EXPECT_GE(free_spheres(filled.model), 120);
    double inner = 0;
    for (const Sphere& s : filled.model.spheres) inner += ((s.center - lump_size / 2).cwiseAbs().array() < 12).all();
    EXPECT_GE(inner, 5);
}

TEST(BuildSkeleton, CoversTheSurfaceByDefault) {
    for (const Built& built : {built_limb(), built_plate(), built_lump()}) {
        const double bound = 0.05 * mesh::bounding_box(built.surface.vertices).longest_side();
        double worst = 0;
        for (Eigen::Index v = 0; v < built.surface.vertices.rows(); ++v) {
            const Vec3 vertex = built.surface.vertices.row(v);
            if (mesh::contains(clamp(), vertex)) continue;
            double least = 1e300;
            for (const Sphere& s : built.model.spheres) least = std::min(least, (vertex - s.center).norm() - s.radius);
            worst = std::max(worst, least);
        }
        EXPECT_LE(worst, bound);
        EXPECT_NEAR(built.report.coverage, worst, 1e-9);
        EXPECT_TRUE(built.report.notes.empty());
    }
}

TEST(BuildSkeleton, GivesAsManySpheresAsAskedAndSaysWhatTheyLeaveUncovered) {
    for (int n : {1, 40}) {
        EXPECT_EQ(free_spheres(build(limb(), {.spheres = n}).model), n);
        EXPECT_EQ(free_spheres(build(plate(), {.spheres = n}).model), n);
        EXPECT_EQ(free_spheres(build(lump(), {.spheres = n}).model), n);
    }
    // More than a chain can hold: in layers.
    EXPECT_EQ(free_spheres(build(limb(), {.spheres = 300}).model), 300);
    const Built few = build(lump(), {.spheres = 3});
    EXPECT_GT(few.report.coverage, 3);
    ASSERT_EQ(few.report.notes.size(), 1u);
    EXPECT_NE(few.report.notes[0].find("3 spheres leave"), std::string::npos);
}

TEST(BuildSkeleton, ASymmetricLumpGetsAnEvenFilling) {
    const Model model = built_lump().model;
    Vec3 mean = Vec3::Zero();
    for (const Sphere& s : model.spheres) {
        if (!s.held) mean += s.center / free_spheres(model);
    }
    // In the middle across; a little beyond it along, where no held spheres fill the place.
    EXPECT_NEAR(mean.y(), 20, 0.15);  // jagged cells leave 0.1 mm
    EXPECT_NEAR(mean.z(), 20, 0.15);
    EXPECT_NEAR(mean.x(), 33, 0.3);
}

TEST(BuildSkeleton, ATurnedAndMovedBodyGetsAsManySpheres) {
    for (const auto& body : {limb(), plate(), lump()}) {
        mesh::VolumeMesh turned = body;
        const Mat3 R = Eigen::AngleAxisd(0.7, Vec3(1, 2, -1).normalized()).toRotationMatrix();
        const Vec3 shift(300, -40, 11);
        turned.nodes = (turned.nodes * R.transpose()).rowwise() + shift.transpose();
        const std::vector<mesh::Region> support{mesh::PlaneRegion{shift, R.col(0), 0.1}};
        // Only the covering spheres may differ: the longest side of the box is another one.
        const int upright = free_spheres(build(body, {.coverage = 6}).model);
        EXPECT_NEAR(free_spheres(build(turned, {.coverage = 6}, support).model), upright, 1);
    }
}

TEST(BuildSkeleton, ARingIsALoop) {
    const Vec3 size(80, 80, 10);
    const Eigen::Vector3i cells(16, 16, 2);
    const auto ring = carve(block(size, cells), cells, size,
                            [](const Vec3& x) { return std::max(std::abs(x.x() - 40), std::abs(x.y() - 40)) > 30; });
    const Model model = build(ring, {.spheres = 24}).model;
    EXPECT_EQ(components(model), 1);
    EXPECT_GE(loops(model), 1);
}

TEST(BuildSkeleton, NothingIsLinkedAcrossAGap) {
    // Two limbs on a common foot, a gap of 2 mm between them.
    const Vec3 size(100, 22, 10);
    const Eigen::Vector3i cells(25, 11, 5);
    const auto fork =
        carve(block(size, cells), cells, size, [](const Vec3& x) { return x.x() < 12 || std::abs(x.y() - 11) > 1; });
    const Model model = build(fork, {.spheres = 24}).model;
    int in_limbs = 0;
    for (const Link& link : model.links) {
        const Vec3 &a = model.spheres[link.a].center, &b = model.spheres[link.b].center;
        if (a.x() < 20 || b.x() < 20) continue;
        ++in_limbs;
        EXPECT_GT((a.y() - 11) * (b.y() - 11), 0);
    }
    EXPECT_GE(in_limbs, 10);
}

TEST(BuildSkeleton, ZonesFollowTheBodyFromTheSupport) {
    const Model model = build(limb(), {.spheres = 12, .zones = 3}).model;
    std::vector<int> count(3, 0);
    for (const Link& p : model.links) {
        ++count.at(p.zone);
        for (const Link& q : model.links) {
            const double at_p = model.spheres[p.a].center.x() + model.spheres[p.b].center.x();
            const double at_q = model.spheres[q.a].center.x() + model.spheres[q.b].center.x();
            EXPECT_TRUE(p.zone >= q.zone || at_p < at_q);
        }
    }
    EXPECT_EQ(count, std::vector<int>({4, 4, 4}));
}

TEST(BuildSkeleton, TheSameBodyGivesTheSameSpheres) {
    const Model first = built_limb().model, second = build(limb()).model;
    ASSERT_EQ(first.spheres.size(), second.spheres.size());
    for (std::size_t i = 0; i < first.spheres.size(); ++i) EXPECT_EQ(first.spheres[i].center, second.spheres[i].center);
}

std::string message(const mesh::VolumeMesh& body, const BuildOptions& options,
                    const std::vector<mesh::Region>& supports) {
    try {
        build(body, options, supports);
    } catch (const InvalidInput& error) {
        return error.what();
    }
    return "";
}

TEST(BuildSkeleton, SaysWhatIsWrongWithTheInput) {
    const auto has = [](const std::string& text, const std::string& part) {
        return text.find(part) != std::string::npos;
    };
    const std::vector<mesh::Region> beside{mesh::BoxRegion{Vec3(200, 0, 0), Vec3(210, 9, 9)}};
    const std::string nothing = message(limb(), {}, beside);
    EXPECT_TRUE(has(nothing, "hold nothing")) << nothing;
    EXPECT_TRUE(has(nothing, "(0, 0, 0) to (160, 16, 16) mm")) << nothing;
    EXPECT_TRUE(has(nothing, "(200, 0, 0) to (210, 9, 9) mm")) << nothing;
    EXPECT_TRUE(has(message(limb(), {}, {}), "none is given"));

    const std::vector<mesh::Region> all{mesh::SphereRegion{Vec3(80, 8, 8), 200}};
    EXPECT_TRUE(has(message(limb(), {}, all), "hold the whole body"));
    EXPECT_TRUE(has(message(limb(), {.spheres = -1}, clamp()), "spheres is -1"));
    EXPECT_TRUE(has(message(limb(), {.coverage = -2}, clamp()), "coverage is -2 mm"));
    EXPECT_TRUE(has(message(limb(), {.zones = 0}, clamp()), "zones is 0"));

    // Two blocks with nothing between them.
    const Vec3 size(60, 10, 10);
    const Eigen::Vector3i cells(6, 2, 2);
    const auto apart = carve(block(size, cells), cells, size, [](const Vec3& x) { return std::abs(x.x() - 30) > 12; });
    EXPECT_TRUE(has(message(apart, {}, clamp()), "in several pieces"));
}

}  // namespace palpate::skeleton::built_bodies
