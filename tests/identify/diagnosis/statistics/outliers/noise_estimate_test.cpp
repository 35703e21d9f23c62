#include "identify/diagnosis/statistics/outliers/noise_estimate.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "identify/numerics/random.h"

namespace palpate::identify {
namespace {

/// 30 markers, 5 mm apart, in eight states.
MeasurementSet set_without_noise() {
    MeasurementSet set;
    set.name = "grid";
    for (int m = 0; m < 30; ++m) set.markers.push_back({m, Vec3(5 * (m % 6), 5 * (m / 6), 0), {}});
    for (int s = 0; s < 8; ++s) {
        LoadState state{.probe = s, .contacts = {{Vec3::Zero(), Vec3(0, 0, 1 + s), 1}}};
        for (const Marker& marker : set.markers) state.readings.push_back({marker.id, marker.rest});
        set.states.push_back(state);
    }
    return set;
}

TEST(NoiseEstimate, ASetTellsItsNoiseOnceOrWithEveryReading) {
    MeasurementSet set = set_without_noise();
    EXPECT_FALSE(tells_noise(set));
    set.position_noise = 0.1;
    EXPECT_TRUE(tells_noise(set));
    set.position_noise.reset();
    for (LoadState& state : set.states)
        for (Reading& reading : state.readings) reading.sigma = 0.1;
    EXPECT_TRUE(tells_noise(set));
    set.states.back().readings.back().sigma = missing;
    EXPECT_FALSE(tells_noise(set));
}

TEST(NoiseEstimate, IsTheRoughnessOfErrorsButNoLessThanTheResolution) {
    constexpr double guess = 0.1, noise = 0.03, moved = 5;  // [mm]
    Problem problem = make_problem(set_without_noise(), guess);
    Refit fit;
    fit.V.emplace(noise_alone(problem.rows()));
    fit.residual = noise / guess * RandomStream(1, 0, 0).normals(static_cast<int>(problem.rows()));
    std::vector<std::string> notes{"Another note."};

    Problem coarse = problem;
    estimate_noise_from(fit, moved, 0.01, coarse, notes);
    EXPECT_DOUBLE_EQ(coarse.sigma.minCoeff(), 0.01 * moved);
    EXPECT_DOUBLE_EQ(coarse.sigma.maxCoeff(), 0.01 * moved);
    EXPECT_THAT(notes, testing::ElementsAre("Another note.", testing::HasSubstr("hardly differ")));

    estimate_noise_from(fit, moved, 1e-4, problem, notes);
    // A median of 240 lengths of vectors is known to 3.5 %: 5 sigma, and as they share neighbours
    // a little more.
    EXPECT_NEAR(problem.sigma.minCoeff(), noise, 0.2 * noise);
    EXPECT_THAT(notes, testing::ElementsAre("Another note.", testing::HasSubstr("from how errors differ")));
}

}  // namespace
}  // namespace palpate::identify
