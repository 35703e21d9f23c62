#include "identify/diagnosis/search/screen.h"

#include <gmock/gmock.h>

#include <cmath>
#include <vector>

// Where a refit with a screened effect begins.

namespace palpate::identify {
namespace {

using testing::ElementsAre;

Eigen::VectorXd at(double x) { return Eigen::VectorXd::Constant(1, x); }

/// Starts whose first number is told, and where the objective is asked for.
struct Trial {
    std::function<double(double)> objective;
    std::vector<double> asked = {};

    double begin(const ScreenedEffect& screened, double without) {
        return start_of(screened, without, [&](const Eigen::VectorXd& start) {
            asked.push_back(start[0]);
            return objective(start[0]);
        })[0];
    }
};

TEST(StartOf, IsTheMostThatLeavesTheObjectiveBelowThatWithoutTheEffect) {
    const ScreenedEffect screened{.effect = nullptr, .starts = {at(1), at(0.3), at(0.1), at(0.03)}};
    Trial trial{[](double x) { return 100 - 60 * x + 90 * x * x; }};  // least at a third, too much at 1
    EXPECT_EQ(trial.begin(screened, 100), 0.3);
    EXPECT_THAT(trial.asked, ElementsAre(1, 0.3));
    Trial worse{[](double) { return INFINITY; }};
    EXPECT_EQ(worse.begin(screened, 100), 0.03);
}

TEST(StartOf, OfOneStartAsksForNothing) {
    const ScreenedEffect screened{.effect = nullptr, .starts = {at(1)}};
    Trial trial{[](double) { return INFINITY; }};
    EXPECT_EQ(trial.begin(screened, 100), 1);
    EXPECT_TRUE(trial.asked.empty());
}

TEST(StartOf, OfAScanIsItsBestBeyondTheThreshold) {
    // Nothing flows down to 0.2; from there the objective falls to 0.05 and rises, and below 0.01 nothing stands.
    const ScreenedEffect screened{.effect = nullptr,
                                  .starts = {at(0.03)},
                                  .scan = {at(0.4), at(0.3), at(0.2), at(0.1), at(0.05), at(0.03), at(0.02), at(0.01)}};
    Trial trial{[](double yield) {
        if (yield < 0.015) return double{INFINITY};
        return yield >= 0.2 ? 100 + 1e-6 * yield : 100 + 200 * (std::abs(std::log(yield / 0.05)) - std::log(4));
    }};
    EXPECT_EQ(trial.begin(screened, 100), 0.05);
    EXPECT_THAT(trial.asked, ElementsAre(0.4, 0.3, 0.2, 0.1, 0.05, 0.03, 0.02));  // twice worse: no further
}

TEST(StartOf, OfAScanThatNeverStandsIsTheScreens) {
    const ScreenedEffect screened{.effect = nullptr, .starts = {at(0.03)}, .scan = {at(0.4), at(0.2)}};
    Trial trial{[](double) { return INFINITY; }};
    EXPECT_EQ(trial.begin(screened, 100), 0.03);
}

}  // namespace
}  // namespace palpate::identify
