#include "identify/diagnosis/statistics/outliers/outliers.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "identify/numerics/random.h"

namespace palpate::identify {
namespace {

using testing::IsEmpty;

constexpr int grid_states = 8;

/// Markers on a 6 x 5 grid, 5 mm apart, in eight states: 240 readings, 720 rows.
class Grid : public testing::Test {
protected:
    Grid() {
        MeasurementSet set;
        set.name = "grid";
        for (int m = 0; m < 30; ++m) set.markers.push_back({m, Vec3(5 * (m % 6), 5 * (m / 6), 0), {}});
        for (int s = 0; s < grid_states; ++s) {
            LoadState state{.probe = s, .contacts = {{Vec3::Zero(), Vec3(0, 0, 1 + s), 1}}};
            for (const Marker& marker : set.markers) state.readings.push_back({marker.id, marker.rest});
            set.states.push_back(state);
        }
        problem_ = make_problem(set, 0.1);
    }

    Eigen::VectorXd noise(std::uint64_t seed) const {
        return RandomStream(seed, 0, 0).normals(static_cast<int>(problem_.rows()));
    }

    /// What a missing effect leaves: as large as 30, smooth over the body.
    Eigen::VectorXd smooth() const {
        Eigen::VectorXd result(problem_.rows());
        for (Eigen::Index n = 0; n < problem_.rows(); ++n) {
            const Vec3 x = problem_.rest.row(problem_.coordinate[n] / 3) / 25;
            const double along = x.x() + 0.5 * x.y();
            result[n] =
                (1 + problem_.state[n]) * (1 + along + 0.3 * along * along) * (problem_.coordinate[n] % 3 - 0.7);
        }
        return result;
    }

    /// Errors with some readings moved by `size` in every coordinate, the signs theirs.
    Eigen::VectorXd planted(Eigen::VectorXd errors, const std::vector<int>& readings, double size) const {
        for (const int reading : readings) {
            for (int axis = 0; axis < 3; ++axis) errors[3 * reading + axis] += (reading + axis) % 2 ? size : -size;
        }
        return errors;
    }

    Problem problem_;
};

TEST_F(Grid, PlantedOutliersAreFound) {
    const std::vector<int> off{3, 50, 51, 77, 140, 199, 222};
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
        // 8 sigma in each coordinate: 13.9 in all, 11.5 scales where the median of six adds to the noise
        const Outliers found = find_outliers(problem_, planted(noise(seed), off, 8));
        EXPECT_EQ(found.readings, off) << seed;
        EXPECT_GT(found.log_bayes_factor, 100);  // each adds some 60
        EXPECT_NEAR(found.share, 0.03, 0.011);   // 2.9 %
        EXPECT_EQ(found.width, 8);
    }
}

TEST_F(Grid, PureNoiseHasNone) {
    // A reading is rougher than 5 scales once in 60,000 if its scale is known: 200 draws of 240 readings make about 1.
    int found = 0;
    for (std::uint64_t seed = 1; seed <= 200; ++seed) {
        const Outliers outliers = find_outliers(problem_, noise(seed));
        found += static_cast<int>(outliers.readings.size());
        EXPECT_LT(outliers.log_bayes_factor, 5) << seed;  // never near the 10 of a claim
    }
    EXPECT_LE(found, 5);  // 4 sigma of a Poisson number of mean 1
}

TEST_F(Grid, ASmoothMissingEffectIsNotTakenForOutliers) {
    for (const double size : {0.3, 1.0}) {  // 3 and 9 sigma, rms; next to more, borders look rough: diagnose sees to it
        double most = 0;
        for (std::uint64_t seed = 1; seed <= 20; ++seed) {
            most = std::max(most, find_outliers(problem_, noise(seed) + size * smooth()).log_bayes_factor);
        }
        EXPECT_LT(most, 10) << size;  // what a claim asks for
    }
}

TEST_F(Grid, OutliersAreFoundInASmoothMissingEffect) {
    const std::vector<int> off{3, 77, 140, 222};
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
        const Outliers found = find_outliers(problem_, planted(noise(seed) + 0.3 * smooth(), off, 12));
        EXPECT_EQ(found.readings, off) << seed;
        EXPECT_GT(found.log_bayes_factor, 100);
    }
}

TEST_F(Grid, MoreThanATenthAreNoMatterOfSingleReadings) {
    std::vector<int> off(30);
    for (int i = 0; i < 30; ++i) off[i] = 8 * i;
    const Outliers found = find_outliers(problem_, planted(noise(1), off, 20));
    EXPECT_THAT(found.readings, IsEmpty());
    EXPECT_EQ(found.log_bayes_factor, 0);
    off.resize(20);
    EXPECT_EQ(find_outliers(problem_, planted(noise(1), off, 20)).readings, off);
}

TEST_F(Grid, WhatIsSmallAgainstTheNoiseIsNoOutlier) {
    // Errors much smaller than the noise that is told, with two readings that stick out of them but not of the noise.
    const std::vector<int> off{3, 77};
    const Eigen::VectorXd errors = planted(noise(4), off, 10);
    EXPECT_EQ(find_outliers(problem_, errors).readings, off);
    EXPECT_TRUE(find_outliers(problem_, 0.1 * errors).readings.empty());
}

TEST_F(Grid, NoiseByRoughnessIsInTheUnitOfTheErrors) {
    const Eigen::VectorXd errors = noise(4);
    const double one = noise_by_roughness(problem_, errors);
    EXPECT_NEAR(noise_by_roughness(problem_, 1e-3 * errors), 1e-3 * one, 1e-12 * one);  // rounding
}

TEST_F(Grid, ReadingsWithoutACoordinateCountAsTheyAre) {
    std::vector<char> keep(problem_.rows(), 1);
    keep[3 * 50 + 1] = 0;
    const Problem some = problem_.with_rows(keep);
    Eigen::VectorXd errors = noise(2).head(some.rows());
    errors[3 * 50] += 15;
    EXPECT_EQ(find_outliers(some, errors).readings, std::vector<int>{50});
}

TEST_F(Grid, FewReadingsInAStateCountAsTheyAre) {
    std::vector<char> keep(problem_.rows());
    for (Eigen::Index n = 0; n < problem_.rows(); ++n) keep[n] = problem_.coordinate[n] < 21;  // seven markers
    const Problem few = problem_.with_rows(keep);
    Eigen::VectorXd errors = noise(2).head(few.rows());
    errors.segment<3>(30) << 9, -9, 9;
    EXPECT_EQ(find_outliers(few, errors).readings, std::vector<int>{10});
    EXPECT_DOUBLE_EQ(roughness(few, errors).size[10], errors.segment<3>(30).norm());
}

TEST_F(Grid, NoiseIsToldByRoughness) {
    // 240 lengths of vectors: their median is known to 1.25 * 0.67 / 1.54 / sqrt(240) = 3.5 %, neighbours shared.
    double sum = 0;
    for (std::uint64_t seed = 1; seed <= 40; ++seed) {
        const double known = 0.02;
        const double plain = noise_by_roughness(problem_, known * noise(seed));
        const double with_effect = noise_by_roughness(problem_, known * (noise(seed) + 0.3 * smooth()));
        EXPECT_NEAR(plain / known, 1, 0.2) << seed;  // 5 sigma
        EXPECT_NEAR(with_effect / known, 1, 0.25) << seed;
        sum += with_effect / known / 40;
    }
    EXPECT_NEAR(sum, 1, 0.1);
}

TEST_F(Grid, RowsWithoutKeepsAllOthers) {
    const std::vector<char> keep = rows_without(problem_, {0, 239});
    EXPECT_EQ(std::accumulate(keep.begin(), keep.end(), 0), 714);
    EXPECT_FALSE(keep.front() || keep[2] || keep.back());
    EXPECT_TRUE(keep[3]);
}

}  // namespace
}  // namespace palpate::identify
