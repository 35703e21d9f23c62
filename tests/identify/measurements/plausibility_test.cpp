#include "identify/measurements/plausibility.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace palpate::identify {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

/// A cube of 100 mm and 0.1 MPa that 2 N press in by about 0.2 mm, its numbers off by these factors.
MeasurementSet pressed_cube(double length, double force, double moved) {
    MeasurementSet set;
    set.rest_surface = mesh::make_box({0, 0, 0}, Vec3::Constant(100 * length), {1, 1, 1});
    set.markers.push_back({7, Vec3(100, 50, 50) * length, std::nullopt});
    set.states.push_back({.probe = 1,
                          .contacts = {{Vec3(100, 50, 50) * length, Vec3(-2, 0, 0) * force, 0}},
                          .readings = {{0, Vec3(100 - 0.2 * moved, 50, 50) * length, missing}}});
    return set;
}

TEST(Plausibility, ASoundSetIsLeftAlone) {
    EXPECT_THAT(implausible(pressed_cube(1, 1, 1)), IsEmpty());
    EXPECT_THAT(implausible(pressed_cube(1, 1e-3, 100)), IsEmpty());  // very soft
}

TEST(Plausibility, ASlipOfUnitsShows) {
    EXPECT_THAT(implausible(pressed_cube(1e-4, 1, 1)), Contains(HasSubstr("0.01 mm at its longest, smaller")));
    EXPECT_THAT(implausible(pressed_cube(1e4, 1, 1)), ElementsAre(HasSubstr("1e+06 mm at its longest, larger")));
    EXPECT_THAT(implausible(pressed_cube(1, 1, 1000)), ElementsAre(HasSubstr("marker 7 in probe 1 at time 0")));
    EXPECT_THAT(implausible(pressed_cube(1, 1e9, 1)), ElementsAre(HasSubstr("block of steel")));
    EXPECT_THAT(implausible(pressed_cube(1, 1e-13, 1)), ElementsAre(HasSubstr("less than any solid")));
}

TEST(Plausibility, MarkersInOneSpotAreInAnotherUnit) {
    MeasurementSet set = pressed_cube(1, 1, 1);
    for (int m = 0; m < 3; ++m) set.markers.push_back({m, Vec3(100, 50, 50 + 0.01 * m), std::nullopt});
    EXPECT_THAT(implausible(set), ElementsAre(HasSubstr("All 4 markers lie within 0.02 mm of each other")));
    set.markers.back().rest.z() = 60;
    EXPECT_THAT(implausible(set), IsEmpty());
}

TEST(Plausibility, ASlipOfUnitsShowsInReactions) {
    MeasurementSet set = pressed_cube(1, 1, 1);
    set.tools.push_back({.name = "ball", .shape = mesh::SphereShape{5}});
    LoadState& pressed = set.states.front();
    pressed.contacts.clear();
    pressed.readings.clear();
    pressed.motions.push_back({0, Vec3(-0.2, missing, 0), Vec3::Zero()});
    pressed.reactions.push_back({0, Vec3(-2, missing, missing)});
    EXPECT_THAT(implausible(set), IsEmpty());
    pressed.reactions.front().force.x() = -2e9;
    EXPECT_THAT(implausible(set), ElementsAre(HasSubstr("block of steel")));
}

TEST(Plausibility, AnAbsurdModulusNamesTheLikelyCause) {
    MeasurementSet set = pressed_cube(1, 1, 1);
    EXPECT_EQ(implausible_modulus(0.1, set), "");
    EXPECT_THAT(implausible_modulus(1e8, set), HasSubstr("no solid"));
    EXPECT_THAT(implausible_modulus(1e-7, set), HasSubstr("mN"));
    set.material = MaterialGuess{.young = 0.1};
    EXPECT_EQ(implausible_modulus(0.3, set), "");
    EXPECT_THAT(implausible_modulus(100, set), HasSubstr("1e+03 times"));
}

}  // namespace
}  // namespace palpate::identify
