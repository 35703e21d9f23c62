#include "identify/comparison/error_location.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

namespace palpate::identify {
namespace {

constexpr double noise_sd = 0.05;  // [mm]
constexpr double nan = std::numeric_limits<double>::quiet_NaN();

/// 5 x 4 x 2 markers, 10 mm apart.
Points markers() {
    Points rest(40, 3);
    for (int i = 0; i < 40; ++i) rest.row(i) << 10 * (i % 5), 10 * (i / 5 % 4), 10 * (i / 20);
    return rest;
}

/// Standard normal residuals of some states.
std::vector<Points> noise(int states, unsigned seed) {
    std::mt19937 random(seed);
    std::normal_distribution<double> normal;
    std::vector<Points> result(static_cast<std::size_t>(states), Points(40, 3));
    for (Points& state : result) state = state.unaryExpr([&](double) { return normal(random); });
    return result;
}

ErrorLocations where_of(const std::vector<Points>& whitened) {
    std::vector<Points> mm;
    for (const Points& state : whitened) mm.emplace_back(noise_sd * state);
    return locate_misfit(markers(), mm, whitened);
}

int count_strange(const std::vector<PlaceError>& places) {
    return static_cast<int>(std::ranges::count_if(places, &PlaceError::strange));
}

TEST(ErrorLocations, NoiseAloneIsNotStrange) {
    int marker_alarms = 0, region_alarms = 0;
    for (unsigned seed = 0; seed < 200; ++seed) {
        const ErrorLocations where = where_of(noise(6, seed));
        marker_alarms += count_strange(where.markers) > 0 ? 1 : 0;
        region_alarms += count_strange(where.regions) > 0 ? 1 : 0;
    }
    // 5 % of the sets, 10 +- 3.1; three noise_sd.
    EXPECT_LE(marker_alarms, 19);
    EXPECT_LE(region_alarms, 19);
    RecordProperty("marker_alarms", marker_alarms);
    RecordProperty("region_alarms", region_alarms);
}

TEST(ErrorLocations, AnErrorAtOneMarkerNamesThatMarkerAndItsRegionAlone) {
    std::vector<Points> whitened = noise(6, 1);
    for (Points& state : whitened) state(17, 1) += 5;
    const ErrorLocations where = where_of(whitened);
    ASSERT_EQ(where.markers.size(), 40u);
    for (int i = 0; i < 40; ++i) {
        EXPECT_EQ(where.markers[i].strange, i == 17);
        EXPECT_EQ(where.markers[i].markers, std::vector{i});
        EXPECT_EQ(where.markers[i].at, markers().row(i).transpose());
    }
    // 5 noise_sd in one of three coordinates.
    EXPECT_NEAR(where.markers[17].whitened_rms, std::sqrt(1 + 25.0 / 3), 0.7);  // three noise_sd of 18 readings
    for (const PlaceError& region : where.regions)
        EXPECT_EQ(region.strange, std::ranges::count(region.markers, 17) == 1);
}

TEST(ErrorLocations, ManySmallErrorsShowInTheirRegionOnly) {
    std::vector<Points> whitened(6, Points::Ones(40, 3));
    const PlaceError region = where_of(whitened).regions[3];
    ASSERT_GE(region.markers.size(), 3u);
    // chi^2 is 1.7 a reading: two noise_sd of a marker's 18, no wonder among 40; 3.6 noise_sd of 54 and more.
    for (Points& state : whitened)
        for (const int marker : region.markers) state.row(marker) *= 1.3;
    const ErrorLocations where = where_of(whitened);
    EXPECT_TRUE(where.regions[3].strange);
    EXPECT_EQ(count_strange(where.regions), 1);
    EXPECT_EQ(count_strange(where.markers), 0);
}

TEST(ErrorLocations, RegionsShareTheMarkersOut) {
    const ErrorLocations where = where_of(noise(1, 0));
    EXPECT_EQ(where.regions.size(), 12u);
    std::vector<int> seen(40, 0);
    for (const PlaceError& region : where.regions) {
        EXPECT_FALSE(region.markers.empty());
        Vec3 mean = Vec3::Zero();
        for (const int marker : region.markers) {
            ++seen[marker];
            mean += markers().row(marker).transpose() / static_cast<double>(region.markers.size());
        }
        EXPECT_LT((region.at - mean).norm(), 1e-12);  // round-off
    }
    EXPECT_EQ(seen, std::vector<int>(40, 1));
    // Few markers: three a region, or one region.
    EXPECT_EQ(locate_misfit(markers().topRows(10), {}, {}).regions.size(), 3u);
    EXPECT_EQ(locate_misfit(markers().topRows(2), {}, {}).regions.size(), 1u);
    EXPECT_TRUE(locate_misfit(Points(0, 3), {}, {}).regions.empty());
    // Markers in one place are one region.
    EXPECT_EQ(locate_misfit(Points::Ones(9, 3), {}, {}).regions.size(), 1u);
}

TEST(ErrorLocations, MissingReadingsAreSkipped) {
    std::vector<Points> whitened(2, Points::Ones(40, 3));
    whitened[0](3, 2) = nan;
    whitened[0].row(4).setConstant(nan);
    for (Points& state : whitened) state.row(5).setConstant(nan);
    const ErrorLocations where = where_of(whitened);
    EXPECT_EQ(where.markers[3].coordinates, 5);
    EXPECT_EQ(where.markers[4].coordinates, 3);
    for (const int marker : {3, 4}) {
        EXPECT_NEAR(where.markers[marker].rms_mm, noise_sd, 1e-15);  // round-off
        EXPECT_NEAR(where.markers[marker].whitened_rms, 1, 1e-15);
    }
    EXPECT_EQ(where.markers[5].coordinates, 0);
    EXPECT_TRUE(std::isnan(where.markers[5].p_value));
    EXPECT_TRUE(std::isnan(where.markers[5].rms_mm));
    EXPECT_FALSE(where.markers[5].strange);
    int coordinates = 0;
    for (const PlaceError& region : where.regions) coordinates += region.coordinates;
    EXPECT_EQ(coordinates, 2 * 120 - 1 - 3 - 6);
}

TEST(ErrorLocations, PValueIsThatOfChiSquared) {
    // One marker in one state: chi^2 = 7.815 with three degrees of freedom has p = 0.05.
    const std::vector<Points> whitened{Points::Constant(1, 3, std::sqrt(7.8147279 / 3))};
    EXPECT_NEAR(locate_misfit(Points::Zero(1, 3), whitened, whitened).markers[0].p_value, 0.05, 1e-8);
}

TEST(Holm, IsThatOfTheBook) {
    const std::vector<double> corrected = holm({0.01, 0.04, 0.03, 0.005});  // times 3, 1, 2, 4
    const std::vector<double> expected{0.03, 0.06, 0.06, 0.02};
    for (std::size_t i = 0; i < 4; ++i) EXPECT_NEAR(corrected[i], expected[i], 1e-15);  // round-off
}

TEST(Holm, KeepsTheOrderAndIsNeverBelowTheRawValue) {
    std::mt19937 random(3);
    std::uniform_real_distribution<double> uniform(-6, 0);
    std::vector<double> p(50);
    for (double& value : p) value = std::pow(10, uniform(random));
    p[7] = p[8];
    const std::vector<double> corrected = holm(p);
    for (std::size_t i = 0; i < p.size(); ++i) {
        EXPECT_GE(corrected[i], p[i]);
        EXPECT_LE(corrected[i], 1);
        for (std::size_t j = 0; j < p.size(); ++j) EXPECT_TRUE(p[i] > p[j] || corrected[i] <= corrected[j]);
    }
}

TEST(Holm, WhatWasNotTestedDoesNotCount) {
    const std::vector<double> corrected = holm({0.02, nan, 0.5});
    EXPECT_DOUBLE_EQ(corrected[0], 0.04);
    EXPECT_TRUE(std::isnan(corrected[1]));
    EXPECT_DOUBLE_EQ(corrected[2], 0.5);
}

}  // namespace
}  // namespace palpate::identify
