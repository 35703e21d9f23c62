// Plateaus, and what their means are good for.

#include <gtest/gtest.h>

#include <cmath>

#include "identify/numerics/random.h"
#include "identify/recordings/assembly/states/imported_state.h"
#include "identify/recordings/assembly/states/plateaus.h"

namespace palpate::identify {
namespace {

constexpr double rate = 100;  // [1/s]

/// Three coordinates that go to 0, 4, 9 and back to 0 mm, 2 s each, within a third of a second, under noise.
struct Staircase {
    static constexpr Eigen::Index frames = 900;
    Eigen::VectorXd times = Eigen::VectorXd::LinSpaced(frames, 0, (frames - 1) / rate);
    SignalGroup group{Eigen::MatrixXd(3, frames), {}};

    explicit Staircase(double noise, double creep = 0) {
        RandomStream random(3, 1, 4);
        for (Eigen::Index f = 0; f < frames; ++f) {
            const double t = times[f];
            const auto on = [&](double at) { return std::clamp((t - at) / 0.33, 0.0, 1.0); };
            double value = 4 * on(2) + 5 * on(4.3) - 9 * on(6.6);
            if (t > 2.33 && t < 4.3) value += creep * (t - 2.33);
            if (t >= 4.3) value += creep * 1.97 * (1 - on(6.6));
            for (int axis = 0; axis < 3; ++axis) group.rows(axis, f) = (axis + 1) * value + noise * random.normal();
        }
    }
};

TEST(Plateaus, OfAStaircaseAreFoundWithTheirMeans) {
    for (const double noise : {0.0, 0.02, 0.3}) {
        const Staircase stairs(noise);
        const std::vector<Plateau> plateaus = find_plateaus(stairs.times, {stairs.group});
        ASSERT_EQ(plateaus.size(), 4U) << noise;
        const double heights[]{0, 4, 9, 0};
        for (std::size_t p = 0; p < 4; ++p)
            for (int axis = 0; axis < 3; ++axis) {
                const Plateau part = plateaus[p];
                EXPECT_GT(part.last - part.first, 180) << "nearly all of 1.97 s, and of 2 s at the ends";
                const SteadyValue value =
                    steady_value(stairs.group.rows.row(axis).segment(part.first, part.last - part.first).transpose());
                // 5 sd of 36 draws, and what of a ramp's foot is left in
                EXPECT_NEAR(value.mean, (axis + 1) * heights[p], 5 * value.sigma + 0.01) << noise;
            }
    }
}

TEST(Plateaus, OfAConstantIsOne) {
    Staircase stairs(0.1);
    RandomStream random(1, 1, 1);
    for (double& value : stairs.group.rows.reshaped()) value = 0.1 * random.normal();
    const std::vector<Plateau> plateaus = find_plateaus(stairs.times, {stairs.group});
    ASSERT_EQ(plateaus.size(), 1U);
    EXPECT_EQ(plateaus[0].last - plateaus[0].first, stairs.frames);
}

TEST(Plateaus, OfARampAreNone) {
    Staircase stairs(0.01);
    for (Eigen::Index f = 0; f < stairs.frames; ++f) stairs.group.rows.col(f).setConstant(stairs.times[f]);
    EXPECT_TRUE(find_plateaus(stairs.times, {stairs.group}, {.shortest = 1}).empty());
}

TEST(Plateaus, ThatCreepAreTakenWhereTheyHaveSettled) {
    const Staircase stairs(0.005, 0.1);
    const std::vector<Plateau> plateaus = find_plateaus(stairs.times, {stairs.group});
    ASSERT_EQ(plateaus.size(), 4U);
    const Plateau settled = settled_part(plateaus[1], {stairs.group});
    EXPECT_EQ(settled.last, plateaus[1].last);
    EXPECT_NEAR(static_cast<double>(settled.last - settled.first),
                0.25 * static_cast<double>(plateaus[1].last - plateaus[1].first), 1);  // a frame
    EXPECT_EQ(settled_part(plateaus[0], {stairs.group}).first, plateaus[0].first) << "what stands still is taken whole";
}

TEST(Plateaus, NeedALengthAndAShare) {
    EXPECT_ANY_THROW(PlateauOptions{.shortest = -1}.validate());
    EXPECT_ANY_THROW(PlateauOptions{.still = 0}.validate());
    EXPECT_NO_THROW(PlateauOptions{}.validate());
}

TEST(SteadyValues, KnowHowWellTheyAreKnown) {
    // means of 400 runs of 50 samples scatter by the sigma that each tells, white noise and noise of neighbours alike
    for (const double r : {0.0, 0.8}) {
        double squares = 0, told = 0;
        constexpr int runs = 400, n = 50;
        for (int run = 0; run < runs; ++run) {
            RandomStream random(5, 2, static_cast<std::uint64_t>(run));
            Eigen::VectorXd samples(n);
            double e = random.normal();
            for (double& sample : samples) {
                sample = 7 + e;
                e = r * e + std::sqrt(1 - r * r) * random.normal();
            }
            const SteadyValue value = steady_value(samples);
            squares += (value.mean - 7) * (value.mean - 7);
            told += value.sigma * value.sigma;
        }
        // White runs tell 1.5 times their variance; a short correlated one looks like a drift, and tells 2.3 times it.
        // 4 sd of 400 squares are 28 %.
        EXPECT_GT(told / squares, 1.1) << r;
        EXPECT_LT(told / squares, 2.5) << r;
    }
}

TEST(SteadyValues, OfARampHoldItsDrift) {
    const SteadyValue value = steady_value(Eigen::VectorXd::LinSpaced(101, 0, 6));
    EXPECT_NEAR(value.mean, 3, 1e-14);  // rounding
    EXPECT_NEAR(value.drift, 6, 1e-14);
    EXPECT_NEAR(value.sigma, std::hypot(6, 0.06) / std::sqrt(12), 1e-14);  // equal steps look like rounding, too
}

TEST(SteadyValues, SkipGapsAndSayHowManyTheyAre) {
    Eigen::VectorXd samples = Eigen::VectorXd::Constant(10, 2);
    samples.segment(3, 4).setConstant(std::nan(""));
    EXPECT_EQ(steady_value(samples).samples, 6);
    EXPECT_EQ(steady_value(samples).mean, 2);
    EXPECT_EQ(steady_value(Eigen::VectorXd::Constant(3, std::nan(""))).samples, 0);
}

TEST(ModeratedSigmas, OfFewFramesAreNotSmallByChance) {
    std::vector<SteadyPoint> points(5);
    for (SteadyPoint& point : points) point = {.at = Vec3::Zero(), .sigma = 0.02, .samples = 7};
    points[1].sigma = 1e-9;
    points[2].sigma = missing;  // a track that froze
    points[3].sigma = 0.5;
    points[4] = {};  // not seen
    moderate_sigmas(points);
    EXPECT_DOUBLE_EQ(points[0].sigma, 0.02);
    // four degrees of freedom of the median's sigma beside five of its own
    EXPECT_NEAR(points[1].sigma, 0.02 * std::sqrt(4.0 / 9), 1e-16);  // its own 1e-9 squared, and rounding
    EXPECT_DOUBLE_EQ(points[2].sigma, 0.02 * std::sqrt(4.0 / 9));
    EXPECT_EQ(points[3].sigma, 0.5);
    EXPECT_TRUE(std::isnan(points[4].sigma));
}

TEST(ModeratedSigmas, OfManyFramesAreTheirOwn) {
    std::vector<SteadyPoint> points(3, {.at = Vec3::Zero(), .sigma = 0.02, .samples = 2000});
    points[0].sigma = 0.005;
    moderate_sigmas(points);
    // four degrees of freedom of the median's sigma beside 1998 of its own
    EXPECT_DOUBLE_EQ(points[0].sigma, std::sqrt((4 * 0.02 * 0.02 + 1998 * 0.005 * 0.005) / 2002));
}

}  // namespace
}  // namespace palpate::identify
