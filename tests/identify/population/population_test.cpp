#include "identify/population/population.h"

#include <gtest/gtest.h>

#include <cmath>

#include "identify/numerics/random.h"

namespace palpate::identify {
namespace {

SpecimenNumber normal(const std::string& name, double mean, double sd) {
    return {
        .specimen = name, .draws = Eigen::VectorXd::Constant(1, mean), .weights = Eigen::VectorXd::Ones(1), .sd = sd};
}

/// Specimens about a mean, each read with an error of its own.
struct Population {
    std::vector<double> truth;
    std::vector<SpecimenNumber> specimens;

    Population(int count, double mean, double spread, double error, std::uint64_t seed) {
        RandomStream random(seed, 0, 0);
        for (int i = 0; i < count; ++i) {
            truth.push_back(mean + spread * random.normals(1)[0]);
            // every third one is read three times as badly
            const double own = i % 3 == 0 ? 3 * error : error;
            specimens.push_back(normal("s" + std::to_string(i), truth.back() + own * random.normals(1)[0], own));
        }
    }
};

TEST(Pool, OfEquallyKnownSpecimensIsTheTextbooks) {
    // x_i = -1, 0, 1 each of sd 1, spread certainly t: the mean is 0 with sd sqrt((1 + t^2) / 3), a specimen's own part
    // t^2 / (1 + t^2). The posterior of t by quadrature, its prior half-normal, the mean integrated out.
    const PooledNumber pooled = pool({normal("a", -1, 1), normal("b", 0, 1), normal("c", 1, 1)}, 1);
    double all = 0, variance = 0, shrunken = 0;
    for (double t = 0.0005; t < 8; t += 0.001) {
        const double v = 1 + t * t;
        const double p = std::exp(-0.5 * t * t) * std::pow(v, -1) * std::exp(-1 / v);  // v^(-3/2) v^(1/2) exp(-2 / 2v)
        all += p;
        variance += p * v / 3;
        shrunken += p * t * t / v;
    }
    EXPECT_NEAR(pooled.mean, 0, 1e-9);
    // The grid's steps of a sixth of an octave leave 0.2 % of the one, 0.9 % of the other.
    EXPECT_NEAR(pooled.mean_sd, std::sqrt(variance / all), 0.002);
    EXPECT_NEAR(pooled.specimens[2].mean, shrunken / all, 0.003);
    EXPECT_NEAR(pooled.specimens[0].mean, -pooled.specimens[2].mean, 1e-9);
    EXPECT_NEAR(pooled.specimens[1].mean, 0, 1e-9);
}

TEST(Pool, RecoversMeanAndSpreadAndHalvesTheErrorOfWhatIsPoorlyRead) {
    // 30 specimens that differ by 8 %; readings are off by 8 or 24 %.
    int inside_mean = 0, inside_spread = 0;
    double own_squares = 0, pooled_squares = 0;
    constexpr int populations = 20;
    for (int seed = 1; seed <= populations; ++seed) {
        const Population p(30, std::log(0.3), 0.08, 0.08, static_cast<std::uint64_t>(seed));
        const PooledNumber pooled = pool(p.specimens, 1);
        if (std::abs(pooled.mean - std::log(0.3)) < 2 * pooled.mean_sd) ++inside_mean;
        if (pooled.spread_low < 0.08 && 0.08 < pooled.spread_high) ++inside_spread;
        for (std::size_t i = 0; i < p.truth.size(); i += 3) {
            own_squares += std::pow(pooled.specimens[i].own_mean - p.truth[i], 2);
            pooled_squares += std::pow(pooled.specimens[i].mean - p.truth[i], 2);
        }
    }
    // 95 % of 20; two or more outside of each have a chance of 7 %, four one of 1 in 60.
    EXPECT_GE(inside_mean, populations - 3);
    EXPECT_GE(inside_spread, populations - 3);
    EXPECT_LT(pooled_squares, 0.25 * own_squares);
}

TEST(Pool, NamesASpecimenThatIsUnlikeTheOthers) {
    Population p(12, 0, 0.05, 0.03, 5);
    for (const PooledSpecimen& one : pool(p.specimens, 1).specimens) EXPECT_FALSE(one.is_outlying) << one.specimen;
    p.specimens[4] = normal("odd", 0.6, 0.03);
    for (const PooledSpecimen& one : pool(p.specimens, 1).specimens)
        EXPECT_EQ(one.is_outlying, one.specimen == "odd") << one.specimen << " " << one.p_value;
}

TEST(Pool, TakesDrawsAsWhatTheyAreOf) {
    // Draws of normal posteriors tell what these do, whatever prior they were drawn under, once that is taken off.
    constexpr int count = 4000;
    std::vector<SpecimenNumber> exact, drawn;
    RandomStream random(3, 0, 0);
    for (int i = 0; i < 5; ++i) {
        const double mean = 0.1 * i, sd = 0.1 + 0.02 * i;
        exact.push_back(normal("s", mean, sd));
        // under a prior N(1, 0.3^2): precisions add
        const double variance = 1 / (1 / (sd * sd) + 1 / 0.09), middle = variance * (mean / (sd * sd) + 1 / 0.09);
        SpecimenNumber own{.specimen = "s",
                           .draws = middle + std::sqrt(variance) * random.normals(count).array(),
                           .weights = Eigen::VectorXd::Constant(count, 1.0 / count),
                           .sd = std::sqrt(variance),
                           .prior_mean = 1,
                           .prior_sd = 0.3};
        drawn.push_back(own);
    }
    const PooledNumber a = pool(exact, 1), b = pool(drawn, 1);
    // 128 draws know a mean to a tenth of its deviation.
    EXPECT_NEAR(b.mean, a.mean, 0.15 * a.mean_sd);
    EXPECT_NEAR(b.mean_sd, a.mean_sd, 0.1 * a.mean_sd);
    for (std::size_t i = 0; i < exact.size(); ++i)
        EXPECT_NEAR(b.specimens[i].mean, a.specimens[i].mean, 0.2 * a.specimens[i].sd);
}

}  // namespace
}  // namespace palpate::identify
