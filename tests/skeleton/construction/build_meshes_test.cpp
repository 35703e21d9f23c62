#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <map>

#include "mesh/formats/surface/read_surface.h"
#include "skeleton/construction/build.h"
#include "tests/skeleton/measures.h"
#include "tests/skeleton/shapes.h"

namespace palpate::skeleton {
namespace {

/// Other people's meshes: organs, castings, broken surfaces.
class Meshes : public ::testing::TestWithParam<std::string> {};

TEST_P(Meshes, GetASkeletonThatFollowsThem) {
    const char* data = std::getenv("PALPATE_DATA");
    if (!data) GTEST_SKIP() << "PALPATE_DATA names no folder of meshes";
    const mesh::Surface surface = mesh::read_surface(std::filesystem::path(data) / "meshes" / GetParam());
    const Meshed body = meshed(surface);
    const mesh::SurfaceTree tree(body.surface);
    const double size = mesh::bounding_box(body.surface.vertices).longest_side();
    const Model model = build_skeleton(body.surface, body.volume, {}, {end_clamp(surface)}, {.condense = false});
    const Measures found = measure(model, tree);
    EXPECT_EQ(found.components, 1);
    EXPECT_EQ(found.duplicates, 0);
    EXPECT_LE(found.coverage, 0.05 * size);
    EXPECT_LE(found.worst_center, 1e-6 * size);
    // An eighth of a long link's length.
    EXPECT_LE(found.worst_link, 0.025 * size);
    // Spheres that a limb would have, a plate, a lump, and what covers their corners.
    EXPECT_GE(found.free, 10);
    EXPECT_LE(found.free, 200);
    const std::map<std::string, int> of_plates{
        {"plate_holes.STL", 5}, {"octagonal_pocket.stl", 1}, {"starfish.stl", 0}, {"idler_riser.STL", 3}};
    if (of_plates.contains(GetParam())) {
        EXPECT_EQ(found.loops, of_plates.at(GetParam()));
    }

    double mass = 0;
    for (const Sphere& s : model.spheres) mass += s.mass;
    const double expected = fem::Material{}.density * mesh::element_volumes(body.volume).sum();
    EXPECT_NEAR(mass, expected, 1e-9 * expected);
}

INSTANTIATE_TEST_SUITE_P(Shared, Meshes,
                         ::testing::Values("angle_block.STL", "carotids.stl", "featuretype.STL", "idler_riser.STL",
                                           "liver-smooth.obj", "liver2.obj", "octagonal_pocket.stl", "plate_holes.STL",
                                           "pliers_binary.stl", "softarm_Cylinder_Hex_Hole.stl", "starfish.stl",
                                           "tube.obj", "wallhole.obj", "dragon_clean.obj"),
                         [](const auto& tested) {
                             std::string name = tested.param.substr(0, tested.param.find('.'));
                             std::replace(name.begin(), name.end(), '-', '_');
                             return name;
                         });

}  // namespace
}  // namespace palpate::skeleton
