#include <gtest/gtest.h>

#include <cmath>

#include "tests/skeleton/construction/built_bodies.h"

namespace palpate::skeleton::built_bodies {

/// A bracket that is bolted to a wall by all of the back of its upright, x = 0: no depth of it is held, and every
/// sphere that stands there is tied to the wall.
TEST(BuildSkeleton, APlateThatIsHeldByItsFaceBearsWhatGrowsOutOfIt) {
    const Vec3 size(60, 30, 48);
    const Eigen::Vector3i cells(20, 10, 16);
    const mesh::VolumeMesh bracket =
        carve(block(size, cells), cells, size, [](const Vec3& p) { return p.x() < 6 || p.z() < 6; });
    const Model model = build(bracket).model;
    std::vector<char> tied(model.spheres.size(), 0);
    for (const Link& link : model.links) {
        if (model.spheres[link.a].held) tied[link.b] = 1;
        if (model.spheres[link.b].held) tied[link.a] = 1;
    }
    for (std::size_t i = 0; i < model.spheres.size(); ++i) {
        const Vec3& center = model.spheres[i].center;
        const bool stands_on_it = !model.spheres[i].held && center.x() < 5 && center.z() > 9;
        EXPECT_TRUE(tied[i] || !stands_on_it) << center.transpose();
    }
    const fem::Material material;
    const auto beam = [&](double width, double height) {
        const double I = width * std::pow(height, 3) / 12, area = width * height;
        return 1e-3 * (std::pow(54., 3) / (3 * material.young * I) + 54 / (5. / 6 * material.shear_modulus() * area));
    };
    const double down = sag(model, Vec3(60, 15, 3)) / beam(30, 6);
    EXPECT_NEAR(down, 1.42, 0.05);  // the arm's root gives, which the beam's clamp does not
    const double aside = give(model, Vec3(60, 15, 3), Vec3::UnitY()) / beam(6, 30);
    EXPECT_NEAR(aside, 1.50, 0.05);
}

TEST(BuildSkeleton, AThickSupportHoldsWhatLiesInIt) {
    const std::vector<mesh::Region> support{mesh::BoxRegion{Vec3(-1, -1, -1), Vec3(15, 50, 50)}};
    const Model model = build(lump(), {}, support).model;
    double held = 0, mass = 0;
    for (const Sphere& s : model.spheres) {
        mass += s.mass;
        held += s.held ? s.mass : 0;
        EXPECT_EQ(s.held, s.center.x() <= 15 + 1e-9);
    }
    EXPECT_GE(held, 0.25 * mass);  // 15 of 60 mm
}

}  // namespace palpate::skeleton::built_bodies
