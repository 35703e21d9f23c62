#include <gtest/gtest.h>

#include "identify/loading/history/lagged_load.h"

namespace palpate::identify {
namespace {

TEST(PlaceAmong, FindsTheStatesAround) {
    const std::vector<double> times{1, 2, 4};
    const auto expect = [&](double instant, int before, int after, double share) {
        const InstantBetween at = place_among(times, instant);
        EXPECT_EQ(at.before, before) << instant;
        EXPECT_EQ(at.after, after) << instant;
        EXPECT_DOUBLE_EQ(at.share, share) << instant;
    };
    expect(3.5, 1, 2, 0.75);
    expect(1, 0, 1, 0);
    expect(0.25, -1, 0, 0.25);  // from time 0 on
    expect(-3, -1, 0, 0);
    expect(9, 2, 2, 1);  // the last load stays
}

TEST(PlaceAmong, StatesAtOneTimeAndAFirstOneAtTimeZeroAreNoGap) {
    EXPECT_EQ(place_among({0, 1}, -0.5).before, 0);
    EXPECT_DOUBLE_EQ(place_among({0, 1}, -0.5).share, 1);
    const InstantBetween at = place_among({1, 2, 2, 3}, 2.5);
    EXPECT_EQ(at.before, 2);
    EXPECT_EQ(at.after, 3);
    EXPECT_DOUBLE_EQ(at.share, 0.5);
}

TEST(Between, ContactsAtOnePlaceAreOne) {
    const std::vector<mesh::Contact> before{{Vec3(0, 0, 0), Vec3(4, 0, 0), 1}};
    const std::vector<mesh::Contact> after{{Vec3(0, 0, 0), Vec3(0, 8, 0), 1}, {Vec3(5, 0, 0), Vec3(0, 0, 4), 1}};
    const auto on_the_way = between(before, after, 0.25);
    ASSERT_EQ(on_the_way.size(), 2U);
    EXPECT_EQ(on_the_way[0].force, Vec3(3, 2, 0));
    EXPECT_EQ(on_the_way[1].force, Vec3(0, 0, 1));
    EXPECT_EQ(on_the_way[1].point, Vec3(5, 0, 0));
    EXPECT_EQ(between(before, {}, 1).size(), 0U);
}

TEST(Between, AToolThatIsAwayStaysWhereItIs) {
    const std::vector<mesh::ToolMotion> before{{.tool = 0, .translation = Vec3(0, 0, -1)}};
    const std::vector<mesh::ToolMotion> after{{.tool = 0, .translation = Vec3(0, 0, -3)},
                                              {.tool = 1, .translation = Vec3(7, 0, 0)}};
    const auto on_the_way = between(before, after, 0.5, after);
    ASSERT_EQ(on_the_way.size(), 2U);
    EXPECT_EQ(on_the_way[0].translation, Vec3(0, 0, -2));
    EXPECT_EQ(on_the_way[1].translation, Vec3(7, 0, 0));
}

TEST(Between, AnActuatorThatIsOffIsAtZero) {
    const auto on_the_way = between({}, std::vector<mesh::ActuatorSetting>{{2, 8}}, 0.25);
    ASSERT_EQ(on_the_way.size(), 1U);
    EXPECT_EQ(on_the_way[0].actuator, 2);
    EXPECT_DOUBLE_EQ(on_the_way[0].value, 2);
}

}  // namespace
}  // namespace palpate::identify
