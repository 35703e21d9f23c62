#include "pipeline/synthesis/rig/rig_probes.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "mesh/core/volume_mesh.h"
#include "mesh/errors.h"
#include "mesh/geometry/surface_tree.h"
#include "pipeline/synthesis/blind_set.h"
#include "tests/identify/small_body.h"
#include "tests/messages.h"

namespace palpate::pipeline {
namespace {

mesh::Surface block() { return mesh::boundary_surface(mesh::make_bar(Vec3::Zero(), Vec3(60, 40, 30), {9, 6, 4})); }

RigProbes probes_of(const RigOptions& options, int count = 5) {
    options.validate();
    return rig_probes(block(), {mesh::BoxRegion{Vec3(-1, -1, -1), Vec3(61, 41, 0.1)}}, options, {.probes = count}, 1);
}

TEST(RigProbes, StartWhereTheToolJustTouches) {
    const RigProbes made = probes_of({.tool = "sphere:radius=6", .depth = {0.5, 1}});
    ASSERT_EQ(made.rig.tools.size(), 1U);
    ASSERT_EQ(made.histories.size(), 5U);
    const mesh::SurfaceTree tree(block());
    for (const ProbeLoadHistory& history : made.histories) {
        ASSERT_TRUE(history.drive.drives());
        const Vec3 centre = made.rig.tools[0].origin + history.drive.from;
        EXPECT_NEAR(tree.closest(centre).distance, 6,
                    0.006 * 6);  // it may lie that much deeper, by rounding of a place
        EXPECT_FALSE(tree.inside(centre));
        EXPECT_NEAR(history.drive.along.norm(), 1, 1e-12);
        // Pressed in by so much it is so much nearer.
        EXPECT_NEAR(tree.closest(centre + history.drive.along).distance, 5, 0.01);
        const identify::LoadState state = history.state(1);
        ASSERT_EQ(state.motions.size(), 1U);
        EXPECT_NEAR((state.motions[0].translation - history.drive.from).norm(), 1, 1e-12);
        EXPECT_TRUE(state.contacts.empty());
    }
}

TEST(RigProbes, KeepToolsOffWhatHoldsTheBody) {
    const double radius = 6;
    const RigProbes made = probes_of({.tool = "sphere:radius=6", .depth = {0.5}}, 8);
    const mesh::SurfaceTree tree(block());
    for (const ProbeLoadHistory& history : made.histories) {
        const Vec3 place = tree.closest(made.rig.tools[0].origin + history.drive.from).position;
        EXPECT_GT(place.z(), 0.1 + radius);  // the block is held up to there
    }
}

TEST(RigProbes, PressAPunchAlongItsAxisAlone) {
    const RigProbes made = probes_of({.tool = "flat:radius=3", .depth = {0.5}}, 3);
    const auto& punch = std::get<mesh::FlatShape>(made.rig.tools[0].shape);
    for (const ProbeLoadHistory& history : made.histories) EXPECT_GT(history.drive.along.dot(punch.axis), 0.999);
}

TEST(RigProbes, SetEachActuatorToEachValue) {
    const RigProbes made =
        probes_of({.pressure = {0.01, 0.02}, .tendon = {"0,0,5 30,20,15", "60,0,5 30,20,15"}, .pull = {1}});
    EXPECT_EQ(made.rig.actuators.size(), 3U);
    ASSERT_EQ(made.histories.size(), 4U);
    EXPECT_EQ(made.histories[1].state(0).actuations[0].value, 0.02);
    EXPECT_EQ(made.histories[3].state(0).actuations[0].actuator, 2);
    EXPECT_TRUE(std::get<mesh::TendonActuator>(made.rig.actuators[2].kind).by_length);
    EXPECT_TRUE(made.histories[3].settings(0).empty());
}

TEST(RigProbes, RefuseWhatCannotBeMeant) {
    const auto message = [](const RigOptions& options) {
        return message_of<InvalidInput>([&] { probes_of(options); });
    };
    EXPECT_TRUE(says(message({.tool = "cube:radius=3", .depth = {1}}), {"--tool", "cube", "sphere:radius=5"}));
    EXPECT_TRUE(says(message({.tool = "sphere", .depth = {1}}), {"--tool", "radius above 0", "flat:radius=4"}));
    EXPECT_TRUE(
        says(message({.tool = "sphere:radius", .depth = {1}}), {"--tool", "sphere:radius", "write sphere:radius=5"}));
    EXPECT_TRUE(says(message({.tool = "sphere:radius=5"}), {"--tool", "--depth", "both"}));
    EXPECT_TRUE(says(message({.depth = {1}}), {"--depth", "--tool"}));
    EXPECT_TRUE(says(message({.tool = "sphere:radius=5", .depth = {2, 1}}), {"--depth", "2, 1", "rise"}));
    EXPECT_TRUE(says(message({.cavity = {"1,2,3"}}), {"--cavity", "--pressure"}));
    EXPECT_TRUE(says(message({.cavity = {"1,2"}, .pressure = {0.1}}), {"--cavity", "1,2", "2 numbers"}));
    EXPECT_TRUE(says(message({.cavity = {"1,2,c"}, .pressure = {0.1}}), {"--cavity", "c", "no number"}));
    EXPECT_TRUE(says(message({.tendon = {"1,2,3"}, .tension = {1}}), {"--tendon", "1 point", "two or more"}));
    EXPECT_TRUE(says(message({.tendon = {"1,2,3 4,5,6"}}), {"--tendon", "--tension or --pull"}));
    EXPECT_TRUE(says(message({.tendon = {"1,2,3 4,5,6"}, .tension = {1}, .pull = {1}}), {"--tension", "--pull"}));
    EXPECT_TRUE(says(message({.tendon = {"-9,2,3 4,5,6"}, .tension = {1}}),
                     {"--tendon", "point 1", "'tendon1'", "9 mm outside", "0.6 mm"}));
    EXPECT_TRUE(says(message({.pressure = {0.1}, .reaction_noise = 1}), {"--reaction-noise", "--tool"}));
    EXPECT_TRUE(says(message({.pressure = {0.1}, .markers = false}), {"--no-markers", "--tool"}));
}

/// A bar with a tendon along it, and one that is pressed, as they are synthesised.
class RigSet : public testing::Test {
protected:
    BlindSet made(const RigOptions& rig, const std::vector<std::string>& hide, int probes = 1) const {
        const RigProbes driven =
            rig_probes(mesh::boundary_surface(body_.mesh), body_.supports, rig, {.probes = probes, .radius = 0.1}, 1);
        Specimen specimen;
        specimen.set = body_.set({});
        specimen.set.density = 1e-9;
        specimen.driven = driven.histories;
        specimen.set.tools = driven.rig.tools;
        specimen.set.actuators = driven.rig.actuators;
        specimen.material = fem::Material{.young = 0.3, .poisson = 0.45, .density = 1e-9};
        specimen.stiffness = 0.3;
        specimen.setting = {2, Eigen::Vector2d(std::log(0.3), std::log(0.1)), {}};
        specimen.model = std::make_unique<identify::ReferenceBody>(
            body_.mesh, body_.supports, body_.markers, identify::ReferenceBodyOptions{.young = 0.3, .rig = driven.rig});
        return synthesise(specimen, {.probes = probes}, {.hide = hide, .rig = rig}, 1, 1);
    }

    identify::SmallBody body_;
};

TEST_F(RigSet, TellsWhatActuatorsWereSetTo) {
    const BlindSet found = made({.tendon = {"0,5,8 20,5,8 38,5,8"}, .tension = {0.05, 0.1}}, {"gravity"});
    ASSERT_EQ(found.set.states.size(), 3U);  // and the one at rest
    EXPECT_TRUE(found.set.states[0].actuations.empty());
    EXPECT_EQ(found.set.states[2].actuations[0].value, 0.1);
    EXPECT_TRUE(found.set.states[2].reactions.empty());
    ASSERT_EQ(found.hidden.size(), 1U);
    EXPECT_GT(found.hidden[0].strength.change, 0);
    EXPECT_TRUE(identify::needs_second_format(found.set));
}

TEST_F(RigSet, ReadsTheReactionOfATool) {
    // The contact is 2 mm in radius, by Hertz, and points of the skin 1.2 mm apart.
    body_.mesh = mesh::to_quadratic(mesh::make_bar(Vec3::Zero(), Vec3(40, 10, 10), {16, 4, 4}));
    const BlindSet found = made({.tool = "sphere:radius=4", .depth = {1}, .reaction_noise = 1e-9}, {"none"});
    ASSERT_EQ(found.set.states.size(), 2U);
    const identify::LoadState& pressed = found.set.states[1];
    ASSERT_EQ(pressed.reactions.size(), 1U);
    const Vec3 along = pressed.motions[0].translation;
    EXPECT_GT(pressed.reactions[0].force.norm(), 1e-5);
    EXPECT_TRUE(pressed.reactions[0].moment.array().isNaN().all());  // its cell reads forces
    EXPECT_EQ(found.set.reaction_noise, 1e-9);
    EXPECT_GT(along.norm(), 0.99);
}

TEST_F(RigSet, MayLeaveAllButTheToolUnread) {
    const RigOptions press{.tool = "sphere:radius=4", .depth = {1}, .reaction_noise = 1e-9};
    RigOptions alone = press;
    alone.markers = false;
    const BlindSet seen = made(press, {"none"}), felt = made(alone, {"none"});
    EXPECT_FALSE(seen.set.markers.empty());
    EXPECT_TRUE(felt.set.markers.empty());
    ASSERT_EQ(felt.set.states.size(), seen.set.states.size());
    EXPECT_TRUE(felt.set.states[1].readings.empty());
    EXPECT_EQ(felt.set.states[1].reactions.at(0).force, seen.set.states[1].reactions.at(0).force);
}

/// Strengths and noise are of what is read: of forces, in N.
TEST_F(RigSet, ComparesForcesWhereNoMarkersAreRead) {
    const RigOptions alone{.tool = "sphere:radius=4", .depth = {1}, .reaction_noise = 0, .markers = false};
    const BlindSet bare = made(alone, {"none"}), slipped = made(alone, {"slip:share=0.8"});
    const auto force = [](const BlindSet& found) { return found.set.states.at(1).reactions.at(0).force; };
    const double whole = force(bare).norm(), change = (force(slipped) - force(bare)).norm();
    EXPECT_NEAR(slipped.strength.displacement, whole / std::sqrt(3), 1e-4 * whole);
    EXPECT_NEAR(slipped.strength.change, change / std::sqrt(3), 1e-4 * whole);
    EXPECT_NEAR(slipped.hidden.at(0).strength.change, slipped.strength.change, 1e-4 * whole);
    EXPECT_EQ(slipped.noise, 0);
}

TEST_F(RigSet, HidesThatAToolMovesLessThanReported) {
    const auto reaction_at = [&](double depth, const char* effect) {
        const BlindSet found = made({.tool = "sphere:radius=4", .depth = {depth}, .reaction_noise = 0}, {effect});
        const identify::LoadState& pressed = found.set.states.at(1);
        EXPECT_NEAR(pressed.motions.at(0).translation.norm(), depth, 1e-9);
        return pressed.reactions.at(0).force.norm();
    };
    const double reported = reaction_at(1, "none"), slipped = reaction_at(1, "slip:share=0.8");
    EXPECT_NEAR(slipped, reaction_at(0.8, "none"), 1e-4 * reported);
    EXPECT_LT(slipped, 0.95 * reported);
}

TEST_F(RigSet, HidesThatAnActuatorDoesMoreThanItIsSetTo) {
    const std::vector<std::string> tendons{"0,5,8 20,5,8 38,5,8", "0,5,2 20,5,2 38,5,2"};
    const auto configurations = [&](double tension, const char* effect) {
        return made({.tendon = tendons, .tension = {tension}}, {effect}).configurations;
    };
    const auto twice = configurations(0.1, "none"), gained = configurations(0.05, "actuation-gain:gain=2"),
               bare = configurations(0.05, "none");
    ASSERT_EQ(gained.size(), 3U);  // at rest, and each tendon drawn
    EXPECT_LT((gained[1] - twice[1]).norm(), 1e-4 * (bare[1] - bare[0]).norm());
    EXPECT_LT((gained[2] - bare[2]).norm(), 1e-4 * (bare[2] - bare[0]).norm());
}

TEST_F(RigSet, RefusesWhatItDoesNotShow) {
    const RigOptions press{.tool = "sphere:radius=4", .depth = {0.3}};
    for (const char* effect : {"force-gain", "viscosity"}) {
        EXPECT_TRUE(says(message_of<InvalidInput>([&] { made(press, {effect}); }), {effect, "--tool"}));
    }
    EXPECT_TRUE(says(message_of<InvalidInput>([&] { made(press, {"slip"}, 3); }), {"slip", "places", "--probes 1"}));
    const RigOptions draw{.tendon = {"0,5,8 38,5,8"}, .tension = {0.1}};
    EXPECT_TRUE(says(message_of<InvalidInput>([&] { made(draw, {"slip"}); }), {"slip", "--tool"}));
    EXPECT_TRUE(says(message_of<InvalidInput>([&] { made(draw, {"actuation-gain"}); }),
                     {"actuation-gain", "beside", "--tendon"}));
}

}  // namespace
}  // namespace palpate::pipeline
