#include "identify/measurements/measurement_set.h"

#include <gtest/gtest.h>

namespace palpate::identify {
namespace {

TEST(Reading, IsUsableWithAMarkerAndACoordinate) {
    EXPECT_TRUE(is_usable({.marker = 0, .position = {1, 2, 3}}));
    EXPECT_TRUE(is_usable({.marker = 0, .position = {missing, missing, 3}}));
    EXPECT_FALSE(is_usable({.marker = 0, .position = Vec3::Constant(missing)}));
    EXPECT_FALSE(is_usable({.marker = -1, .position = {1, 2, 3}})) << "unlabelled";
}

TEST(LoadState, AContactOfNoForceIsNoLoad) {
    LoadState state;
    EXPECT_FALSE(has_contact_force(state));
    state.contacts.push_back({.point = {1, 2, 3}, .force = Vec3::Zero(), .radius = 1});
    EXPECT_FALSE(has_contact_force(state));
    state.contacts.push_back({.point = {1, 2, 3}, .force = {0, 0, -1}, .radius = 1});
    EXPECT_TRUE(has_contact_force(state));
}

}  // namespace
}  // namespace palpate::identify
