#include "identify/loading/tool_motions.h"

#include <gtest/gtest.h>

#include <limits>

namespace palpate::identify {
namespace {

constexpr double left_free = std::numeric_limits<double>::quiet_NaN();

TEST(ToolMotions, RoamWhereTheyMoveFartherThanTheyAreWide) {
    const auto by = [](double x) { return mesh::ToolMotion{.tool = 0, .translation = Vec3(x, 0, 0)}; };
    const mesh::Tool ball{.name = "ball", .shape = mesh::SphereShape{5}};
    EXPECT_TRUE(may_part(ball));
    EXPECT_FALSE(roams(ball, by(4)));
    EXPECT_TRUE(roams(ball, by(-6)));
    EXPECT_FALSE(roams(ball, by(left_free))) << "left free";
    mesh::Tool glued = ball;
    glued.bonded = true;
    EXPECT_FALSE(may_part(glued));
    EXPECT_FALSE(roams(glued, by(60))) << "it takes the body along";
    const mesh::Tool grip{.name = "grip", .shape = mesh::GripShape{}, .bonded = true};
    EXPECT_FALSE(may_part(grip));
    EXPECT_FALSE(roams(grip, by(60)));
    mesh::SurfaceShape plate{{}};
    plate.surface.vertices = (Points(3, 3) << 0, 0, 0, 20, 0, 0, 0, 8, 0).finished();
    const mesh::Tool platen{.name = "platen", .shape = plate};
    EXPECT_FALSE(roams(platen, by(9)));
    EXPECT_TRUE(roams(platen, by(11)));
}

}  // namespace
}  // namespace palpate::identify
