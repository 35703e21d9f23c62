#include "identify/measurements/rig/fittable.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "tests/identify/rig_files.h"

namespace palpate::identify {
namespace {

// Displacements since a state are positions only where nothing acts in it.

TEST_F(RigFiles, DisplacementsSinceAnUnloadedStateArePositions) {
    folder.write("probes.csv", "probe,time,x,y,z,fx,fy,fz,radius\n9,0,0,0,0,0,0,0,0\n");
    folder.write("displacements.csv", displacements + "9,0,7,0,0,0,\n");
    const std::string since = yaml + "displacements: {since: {probe: 9, time: 0}}\n";
    folder.write("set.yaml", since);
    MeasurementSet set = read();
    ASSERT_EQ(set.notes.size(), 1U);
    EXPECT_TRUE(says(set.notes[0], {"1 displacements of the state", "left out"}));
    const LoadState* pressed = find_state(set, {1, 0});
    ASSERT_NE(pressed, nullptr);
    EXPECT_EQ(pressed->readings[0].since, (StateName{9, 0}));
    take_displacements_from_rest(set);
    EXPECT_FALSE(pressed->readings[0].since);
    EXPECT_EQ(pressed->readings[0].position.z(), 19.5);
    EXPECT_TRUE(says(set.notes.back(), {"2 displacements", "positions, from rest"}));

    folder.write("set.yaml", since + "gravity: [0, 0, -9810]\n");
    set = read();
    take_displacements_from_rest(set);
    EXPECT_TRUE(find_state(set, {1, 0})->readings[0].since);
    EXPECT_NO_THROW(require_fittable(set));

    folder.write("set.yaml", yaml + "displacements: {since: {probe: 2, time: 0}}\n");  // the cable pulls there
    set = read();
    take_displacements_from_rest(set);
    EXPECT_TRUE(find_state(set, {1, 0})->readings[0].since);
}

TEST_F(RigFiles, SharedNoiseThatIsNotToldIsNamed) {
    MeasurementSet set = read();
    set.position_correlation = 2;
    set.position_noise.reset();
    set.states[0].readings.push_back({.marker = 0, .position = Vec3(1, 2, 3)});
    std::vector<std::string> names;
    for (const UnfittedPart& part : parts_not_fitted_yet(set)) names.push_back(part.what);
    EXPECT_EQ(names, std::vector<std::string>{"'correlated.position' (2 mm) and no noise"});
    EXPECT_TRUE(says(message_of<InvalidInput>([&] { require_fittable(set); }),
                     {"set 'rig'", "cannot be fitted yet", "noise.position"}));
    take_correlated_noise(set);
    EXPECT_TRUE(set.position_correlation);  // it stays to be told
    set.position_noise = 0.1;
    EXPECT_NO_THROW(require_fittable(set));
}

TEST(CorrelatedNoise, MakesNeighboursCountOnce) {
    // A row of 400 points, ten to a length: a mean over it has the variance of 400 / (10 sqrt(2 pi)) readings.
    MeasurementSet set;
    set.position_noise = 0.1;
    set.position_correlation = 1;
    LoadState state{.probe = 1};
    for (int i = 0; i < 400; ++i) {
        set.markers.push_back({.id = i, .rest = Vec3(0.1 * i, 0, 0), .anchor = {}});
        state.readings.push_back({.marker = i, .position = Vec3(0.1 * i, 0, 1)});
    }
    set.states = {state, state};
    set.states[1].readings.erase(set.states[1].readings.begin() + 1, set.states[1].readings.end());
    take_correlated_noise(set);
    EXPECT_FALSE(set.position_correlation);
    EXPECT_NEAR(set.states[0].readings[200].sigma, 0.1 * std::sqrt(10 * std::sqrt(2 * M_PI)), 1e-6);
    EXPECT_NEAR(set.states[0].readings[0].sigma, 0.1 * std::sqrt(5 * std::sqrt(2 * M_PI) + 0.5), 1e-4);  // half of it
    EXPECT_EQ(set.states[1].readings[0].sigma, 0.1);  // alone in its state
    EXPECT_TRUE(says(set.notes.at(0), {"1 mm", "25 readings count as one"}));
}

TEST_F(RigFiles, TellWhetherAnyForceIsMeasured) {
    MeasurementSet set = read();
    EXPECT_TRUE(tells_a_force(set));  // the cable's tension, the reactions
    for (LoadState& state : set.states) {
        state.actuations.clear();
        state.reactions.clear();
    }
    EXPECT_FALSE(tells_a_force(set));
    set.gravity = Vec3(0, 0, -9810);
    EXPECT_FALSE(tells_a_force(set));  // of what weight?
    set.density = 1e-9;
    EXPECT_TRUE(tells_a_force(set));
}

}  // namespace
}  // namespace palpate::identify
