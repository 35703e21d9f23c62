#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "skeleton/construction/build.h"
#include "tests/skeleton/measures.h"
#include "tests/skeleton/shapes.h"

namespace palpate::skeleton {
namespace {

struct Placed {
    Model model;
    Measures measures;
    double size = 0;  // longest side [mm]
};

Placed place(const mesh::Surface& surface, const mesh::PlaneRegion& support, double share = 0.06,
             const BuildOptions& options = {}) {
    const Meshed body = meshed(surface, share);
    Placed placed;
    BuildOptions without_skin = options;
    without_skin.condense = false;
    placed.model = build_skeleton(body.surface, body.volume, {}, {support}, without_skin);
    placed.measures = measure(placed.model, mesh::SurfaceTree(body.surface));
    placed.size = mesh::bounding_box(body.surface.vertices).longest_side();
    return placed;
}

Placed place(const std::string& name, const BuildOptions& options = {}) {
    const Shape body = shape(name);
    return place(body.surface, end_clamp(body.surface), 0.06, options);
}

void expect_alike(const Placed& placed, const Placed& base) {
    EXPECT_NEAR(placed.measures.free, base.measures.free, 0.1 * base.measures.free);
    EXPECT_EQ(placed.measures.components, 1);
    EXPECT_EQ(placed.measures.loops, base.measures.loops);
    EXPECT_EQ(placed.measures.tips, base.measures.tips);
}

class Placement : public ::testing::TestWithParam<std::string> {};

TEST_P(Placement, FollowsTheBody) {
    const Shape body = shape(GetParam());
    const Placed placed = place(GetParam());
    const Measures& found = placed.measures;
    EXPECT_EQ(found.components, 1);
    EXPECT_EQ(found.duplicates, 0);
    EXPECT_LE(found.coverage, 0.05 * placed.size);
    EXPECT_EQ(found.worst_center, 0);
    // The chord of a bent limb may leave it by a tenth of its length, which is some 10 % of the size.
    EXPECT_LE(found.worst_link, 0.01 * placed.size);
    if (body.thin) {
        EXPECT_EQ(found.loops, body.handles);
    }
    if (body.tips >= 0) {
        EXPECT_EQ(found.tips, body.tips);
    }
}

INSTANTIATE_TEST_SUITE_P(Of, Placement,
                         ::testing::Values("bar", "plate", "sheet", "cube", "ellipsoid", "torus", "double torus", "tee",
                                           "wye", "hollow ball"),
                         [](const auto& tested) {
                             std::string name = tested.param;
                             std::replace(name.begin(), name.end(), ' ', '_');
                             return name;
                         });

/// Noise of 0.2 % of the size on vertices 2 % apart: slopes of some 0.1.
TEST(PlacementOfSpheres, NoiseGrowsNoSpurs) {
    for (const char* name : {"wye", "double torus"}) {
        const Shape body = shape(name);
        expect_alike(place(noisy(body.surface, 0.002, 1), end_clamp(body.surface)), place(name));
    }
}

/// Noise of 0.5 % of the size on vertices 6 % apart.
TEST(PlacementOfSpheres, CoarseNoiseGrowsNoSpurs) {
    for (const char* name : {"wye", "torus"}) {
        const Shape body = shape(name);
        const mesh::Surface coarse = meshed(body.surface).surface;
        expect_alike(place(noisy(coarse, 0.005, 1), end_clamp(body.surface), 0.03), place(name));
    }
}

TEST(PlacementOfSpheres, DoesNotDependOnTheMesh) {
    for (const char* name : {"wye", "plate"}) {
        const Shape body = shape(name);
        const Placed base = place(name);
        expect_alike(place(body.surface, end_clamp(body.surface), 0.12), base);
        expect_alike(place(body.surface, end_clamp(body.surface), 0.03), base);
    }
}

TEST(PlacementOfSpheres, DoesNotDependOnThePlaceInSpace) {
    const Motion motion = some_motion();
    for (const char* name : {"tee", "plate"}) {
        const Shape body = shape(name);
        // As fine in millimetres: the longest side of a turned body's box is another one.
        const mesh::Surface turned = motion(body.surface);
        const double size = mesh::bounding_box(body.surface.vertices).longest_side();
        const double share = 0.06 * size / mesh::bounding_box(turned.vertices).longest_side();
        const BuildOptions options{.coverage = 0.05 * size};
        expect_alike(place(turned, motion(end_clamp(body.surface)), share, options), place(name, options));
    }
}

TEST(PlacementOfSpheres, TheSameFileGivesTheSameSpheresAndAnotherOrderAsMany) {
    const Shape body = shape("tee");
    const Placed first = place("tee"), second = place("tee");
    ASSERT_EQ(first.model.spheres.size(), second.model.spheres.size());
    for (std::size_t i = 0; i < first.model.spheres.size(); ++i) {
        EXPECT_LT((first.model.spheres[i].center - second.model.spheres[i].center).norm(), 1e-6 * first.size);
        EXPECT_NEAR(first.model.spheres[i].radius, second.model.spheres[i].radius, 1e-6 * first.size);
    }
    expect_alike(place(shuffled(body.surface, 3), end_clamp(body.surface)), first);
}

TEST(PlacementOfSpheres, CoverageGetsBetterWithMoreSpheres) {
    for (const char* name : {"plate", "ellipsoid"}) {
        double last = std::numeric_limits<double>::infinity();
        for (int spheres : {8, 32, 128}) {
            const Placed placed = place(name, {.spheres = spheres});
            EXPECT_EQ(placed.measures.free, spheres);
            EXPECT_LT(placed.measures.coverage, last);
            last = placed.measures.coverage;
        }
    }
    // As asked for, in millimetres.
    EXPECT_LE(place("ellipsoid", {.coverage = 3}).measures.coverage, 3);
}

/// Handles are kept when few spheres are asked for: some are taken for them.
TEST(PlacementOfSpheres, FewSpheresGoRoundAHandle) {
    const Placed placed = place("torus", {.spheres = 6});
    EXPECT_EQ(placed.measures.free, 6);
    EXPECT_EQ(placed.measures.loops, 1);
}

/// In single file down the middle of limbs, within a third of the distance between two.
TEST(PlacementOfSpheres, ChainsAreSymmetric) {
    for (const char* name : {"bar", "tee", "wye"}) {
        const Shape body = shape(name);
        const Placed placed = place(name);
        // 0.14 is the worst: cells are not mirrored
        for (int k : {1, 2}) EXPECT_LT(asymmetry(placed.model, body.mirrors.col(k), Vec3::Zero()), 0.15) << name;
    }
}

}  // namespace
}  // namespace palpate::skeleton
