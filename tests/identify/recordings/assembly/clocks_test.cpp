// Clocks of several logs on each other: by edges, and by the lag at which force and motion agree best.

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "identify/numerics/random.h"
#include "identify/recordings/assembly/clocks/common_column.h"
#include "identify/recordings/assembly/clocks/lag.h"
#include "identify/recordings/assembly/clocks/triggers.h"
#include "tests/messages.h"

namespace palpate::identify {
namespace {

Signal sampled(const std::function<double(double)>& f, double from, double to, double rate, double noise = 0,
               std::uint64_t key = 1) {
    const auto n = static_cast<Eigen::Index>((to - from) * rate) + 1;
    Signal signal{Eigen::VectorXd(n), Eigen::VectorXd(n)};
    RandomStream random(7, key, 0);
    for (Eigen::Index i = 0; i < n; ++i) {
        signal.times[i] = from + static_cast<double>(i) / rate;
        signal.values[i] = f(signal.times[i]) + noise * random.normal();
    }
    return signal;
}

/// Loads of 1, 3 and 2 that come and go within 0.2 s.
double steps(double t) {
    const auto on = [&](double at) { return 1 / (1 + std::exp(-(t - at) / 0.03)); };
    return on(2) - on(4) + 3 * (on(5.3) - on(7)) + 2 * (on(9.1) - on(10));
}
/// What a stiffening body answers by.
double answer(double t) { return 2 * steps(t) + 0.1 * steps(t) * steps(t); }

TEST(Lags, OfAForceBehindAMotionAreFoundToTwoMilliseconds) {
    for (const double lag : {-1.357, 0.0, 0.8243}) {
        const Signal motion = sampled(steps, 0, 12, 100, 0.01, 2);
        const Signal force = sampled([&](double t) { return answer(t + lag); }, 0, 12, 1000, 0.02, 3);
        const LagEstimate estimate = estimate_lag(motion, force);
        EXPECT_TRUE(estimate.is_clear) << lag;
        EXPECT_NEAR(estimate.clock.offset, lag, 4 * estimate.clock.sd);
        EXPECT_LT(estimate.clock.sd, 2.5e-4);  // [s]: 0.2 ms, so that 4 sd are below the two milliseconds
        EXPECT_EQ(estimate.clock.rate, 1);
    }
}

TEST(Lags, WithAClockThatRunsFastTellItsRate) {
    constexpr double rate = 1.004, lag = 0.2;
    const Signal motion = sampled(steps, 0, 12, 100, 0.002, 2);
    const Signal force = sampled([&](double t) { return answer(lag + rate * t); }, 0, 11.5, 500, 0.004, 3);
    const LagEstimate estimate = estimate_lag(motion, force);
    ASSERT_GT(estimate.clock.rate_sd, 0);
    EXPECT_NEAR(estimate.clock.rate, rate, 4 * estimate.clock.rate_sd);
    EXPECT_LT(estimate.clock.rate_sd, 7e-5);  // 5e-5 of 12 s
    EXPECT_NEAR(estimate.clock.offset + estimate.clock.rate * 6, lag + rate * 6, 4 * estimate.clock.sd);
}

TEST(Lags, OfAnEvenBeatAreNotClear) {
    const auto beat = [](double t) { return std::sin(2 * 3.14159265 * t); };
    EXPECT_FALSE(estimate_lag(sampled(beat, 0, 10, 100), sampled(beat, 0, 10, 200)).is_clear);
}

TEST(Lags, OfNoiseAreNotClear) {
    const auto nothing = [](double) { return 0.0; };
    EXPECT_FALSE(estimate_lag(sampled(nothing, 0, 10, 100, 1, 2), sampled(nothing, 0, 10, 100, 1, 3)).is_clear);
}

TEST(Triggers, AreEdgesOnceEachWhateverTheNoise) {
    const auto pulse = [](double t) { return std::fmod(t, 4) >= 2 ? 5.0 : 0.0; };
    const std::vector<double> edges = edges_of(sampled(pulse, 0, 9, 100, 0.1), true, std::nullopt);
    ASSERT_EQ(edges.size(), 2U);
    EXPECT_NEAR(edges[0], 2, 0.006);  // [s]: half a sample, and noise of a fiftieth of the edge
    EXPECT_NEAR(edges[1], 6, 0.006);
    EXPECT_EQ(edges_of(sampled(pulse, 0, 9, 100, 0.1), false, std::nullopt).size(), 2U);
}

TEST(Triggers, OfTwoClocksTellOffsetAndRate) {
    const std::vector<double> reference{10, 12.5, 19};
    std::vector<double> other;
    for (const double t : reference) other.push_back((t - 3) / 1.001);
    const auto fit = match_edges(reference, other, 0.01, 0.001);
    ASSERT_TRUE(fit);
    EXPECT_NEAR(fit->offset, 3, 1e-13);  // rounding of times of 20 s
    EXPECT_NEAR(fit->rate, 1.001, 1e-14);
    EXPECT_GT(fit->rate_sd, 0);
}

TEST(Triggers, ThatOneSideHasMissedArePairedByTheirIntervals) {
    const auto fit = match_edges({1, 2, 5, 11}, {102, 105, 111}, 0.01, 0.01);
    ASSERT_TRUE(fit);
    EXPECT_NEAR(fit->offset + fit->rate * 105, 5, 1e-13);  // rounding of times of 100 s
    EXPECT_FALSE(match_edges({1, 2, 3, 4}, {102, 103, 104}, 0.01, 0.01)) << "an even beat tells nothing";
    EXPECT_FALSE(match_edges({1, 2}, {102}, 0.01, 0.01));
    EXPECT_FALSE(match_edges({}, {102}, 0.01, 0.01));
}

TEST(Signals, TellTheirNoiseThroughAnyMotion) {
    const Signal moved = sampled([](double t) { return 5 * std::sin(t); }, 0, 10, 1000, 0.05);
    EXPECT_NEAR(noise_of(moved.values), 0.05, 0.003);  // 3 sd of 2 %, the sampling error of a median of 10^4
    const Signal rounded = sampled([](double t) { return std::round(10 * t) / 10; }, 0, 10, 1000);
    EXPECT_NEAR(noise_of(rounded.values), 0.1 / std::sqrt(12), 1e-14);  // rounding
}

TEST(Signals, ThatRiseWithNoiseAreMadeMonotone) {
    const Signal noisy = sampled([](double t) { return t; }, 0, 10, 50, 0.3);
    const Signal rising = monotone(noisy);
    for (Eigen::Index i = 1; i < rising.values.size(); ++i) EXPECT_GE(rising.values[i], rising.values[i - 1]);
    EXPECT_NEAR((rising.values - noisy.values).mean(), 0, 1e-14);  // pooling keeps the sum
    const Signal falling = monotone({noisy.times, -noisy.values});
    EXPECT_NEAR((falling.values + rising.values).norm(), 0, 1e-13);  // rounding
}

TEST(CommonColumn, TakesTimesToThoseAtWhichTheReferenceShowsTheSame) {
    const Signal rising{Eigen::Vector3d(0, 1, 2), Eigen::Vector3d(0, 10, 20)},
        falling{Eigen::Vector3d(0, 1, 2), Eigen::Vector3d(20, 10, 0)},
        other{Eigen::Vector3d(100, 101, 102), Eigen::Vector3d(5, 10, 15)};
    const Signal clock = clock_by_common("stroke", {"a.csv", rising}, {"b.csv", other});
    EXPECT_LT((clock.times - other.times).norm(), 1e-13);  // rounding of 100 s
    EXPECT_LT((clock.values - Eigen::Vector3d(0.5, 1, 1.5)).norm(), 1e-14);
    const Signal back = clock_by_common("stroke", {"a.csv", falling}, {"b.csv", other});
    EXPECT_LT((back.values - Eigen::Vector3d(1.5, 1, 0.5)).norm(), 1e-14);
}

TEST(CommonColumn, RefusesWhatTurnsBackOrHasNoValuesInCommon) {
    const Signal rising{Eigen::Vector3d(0, 1, 2), Eigen::Vector3d(0, 10, 20)},
        turning{Eigen::Vector3d(0, 1, 2), Eigen::Vector3d(0, 20, 0)},
        beyond{Eigen::Vector3d(0, 1, 2), Eigen::Vector3d(30, 40, 50)};
    const auto refusal = [&](const Signal& other) {
        return message_of([&] { clock_by_common("stroke", {"a.csv", rising}, {"b.csv", other}); });
    };
    EXPECT_TRUE(says(refusal(turning), {"b.csv", "'stroke' goes up and down", "lag: auto"}));
    EXPECT_TRUE(says(refusal(beyond), {"b.csv", "from 30 to 50 here and from 0 to 20 in a.csv", "nothing in common"}));
}

}  // namespace
}  // namespace palpate::identify
