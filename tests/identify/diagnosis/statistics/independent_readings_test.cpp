#include "identify/diagnosis/statistics/independent_readings.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>

namespace palpate::identify {
namespace {

/// One marker at the origin, read in z (or in all coordinates) under each load along -z at one place.
Problem curve(int loads, const std::function<double(double)>& displacement, bool as_probes = true,
              double noise = 0.01) {
    MeasurementSet set;
    set.markers = {{1, Vec3::Zero(), std::nullopt}};
    std::mt19937_64 random(3);
    std::normal_distribution<double> chance(0, noise);
    for (int i = 1; i <= loads; ++i) {
        LoadState state{.probe = as_probes ? i : 1, .time = as_probes ? 0.0 : i};
        state.contacts = {{Vec3(5, 0, 0), Vec3(0, 0, -i), 1}};
        state.readings = {{0, Vec3(missing, missing, displacement(i) + chance(random)), noise}};
        set.states.push_back(state);
    }
    return make_problem(set, noise);
}

TEST(IndependentReadings, ProportionalAnswersAreOneHoweverManyLoads) {
    const auto linear = [](double load) { return -0.3 * load; };
    EXPECT_EQ(independent_readings(curve(1, linear)), 1);
    EXPECT_EQ(independent_readings(curve(12, linear)), 1);
    EXPECT_EQ(independent_readings(curve(12, linear, false)), 1);
}

TEST(IndependentReadings, ABentCurveTellsMore) {
    EXPECT_EQ(independent_readings(curve(12, [](double f) { return -0.3 * f + 0.01 * f * f; })), 2);
    EXPECT_GE(independent_readings(curve(12, [](double f) { return -3 * std::tanh(0.3 * f); })), 3);
}

TEST(IndependentReadings, NoiseTellsNothing) {
    EXPECT_EQ(independent_readings(curve(12, [](double) { return 0.0; })), 0);
}

TEST(IndependentReadings, OtherPlacesAndDirectionsAndMarkersCountForThemselves) {
    MeasurementSet set;
    set.markers = {{1, Vec3::Zero(), std::nullopt}, {2, Vec3(1, 0, 0), std::nullopt}};
    int probe = 0;
    for (const Vec3& at : {Vec3(5, 0, 0), Vec3(0, 5, 0)}) {
        for (const Vec3& force : {Vec3(1, 0, 0), Vec3(0, 0, 1), Vec3(0, 0, -2)}) {  // the last along the second
            LoadState state{.probe = ++probe, .contacts = {{at, force, 1}}};
            state.readings = {{0, force, 0.01}, {1, Vec3(1, 0, 0) + 2 * force, 0.01}};
            set.states.push_back(state);
        }
    }
    // two places, two lines, two markers, and of three coordinates the one that moves
    EXPECT_EQ(independent_readings(make_problem(set, 0.01)), 8);
}

}  // namespace
}  // namespace palpate::identify
