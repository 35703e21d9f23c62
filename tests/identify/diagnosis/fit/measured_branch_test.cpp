#include "identify/diagnosis/fit/measured_branch.h"

#include <gtest/gtest.h>

#include "identify/diagnosis/fit/refit.h"
#include "tests/identify/bar_under_ball.h"

namespace palpate::identify {
namespace {

/// A bar that a ball has pressed down by more than its thickness, of which only the last pose is told.
class PressedOutOfSight : public testing::Test, public BarUnderBall {
protected:
    static constexpr double noise = 0.02;  // [mm]
    static constexpr double depth = 18.5;  // [mm]
    PressedOutOfSight() {
        model_ = reference();
        truth_ = bare_truth(*model_, 2);
        pressed_ = brought_to(*model_, truth_.setting(), depth);
    }
    /// Its readings where the bar stands so.
    Problem problem(const Eigen::VectorXd& q) const {
        MeasurementSet set =
            body.set({LoadState{.probe = 0}, {.probe = 1, .time = 1, .motions = pressed(depth).motions}});
        set.tools = rig().tools;
        set.position_noise = noise;
        RandomStream random(1, 0, 0);
        const Points seen = model_->observe(q, truth_.setting());
        for (Reading& reading : set.states[1].readings)
            reading.position = seen.row(reading.marker).transpose() + noise * Vec3(random.normals(3));
        return make_problem(set);
    }
    static double misfit(const Problem& problem, const ForwardSolution& forward) {
        return problem.rms_mm(problem.measured - problem.pick(forward.markers));
    }

    std::unique_ptr<BodyModel> model_;
    Explanation truth_;
    Eigen::VectorXd pressed_;
};

TEST_F(PressedOutOfSight, TheMeasurementTellsWhichEquilibriumItIs) {
    const Problem seen = problem(pressed_);
    const ForwardSolution lifted = solve_forward(*model_, seen, truth_, 1);
    ASSERT_GT(misfit(seen, lifted), 5);
    const auto found = nearer_to_measured(*model_, seen, truth_, lifted, 1);
    ASSERT_TRUE(found);
    EXPECT_LT(misfit(seen, *found), 1.2 * noise);
    EXPECT_LT((found->q[1] - pressed_).norm(), 1e-4 * pressed_.norm());
    EXPECT_LT(found->channels[1](seen.markers, 2), 0);  // pressed down
    EXPECT_FALSE(nearer_to_measured(*model_, seen, truth_, *found, 1));
}

TEST_F(PressedOutOfSight, AFitBeginsThere) {
    const Problem seen = problem(pressed_);
    const Refit fit = refit(*model_, seen, truth_, {});
    EXPECT_LT(misfit(seen, fit.forward), 1.2 * noise);
}

TEST_F(PressedOutOfSight, AFitFromANeighbourThatStandsElsewhereComesThere) {
    const Problem seen = problem(pressed_);
    Refit lifted;
    lifted.explanation = truth_;
    lifted.explanation.theta[0] += std::log(1.2);
    lifted.forward = solve_forward(*model_, seen, lifted.explanation, 1);
    ASSERT_GT(misfit(seen, lifted.forward), 5);
    const Refit fit = refit(*model_, seen, lifted.explanation, {}, &lifted);
    EXPECT_LT(misfit(seen, fit.forward), 1.2 * noise);
}

TEST_F(PressedOutOfSight, WhatReadingsAskForBesidesIsNotFitted) {
    // Of a bar that bends to the side, as no ball from above or below bends it.
    Points markers = model_->observe(pressed_, truth_.setting());
    Problem seen = problem(pressed_);
    for (Eigen::Index n = 0; n < seen.rows(); ++n)
        if (seen.action[n] == 1 && seen.coordinate[n] % 3 == 1)
            seen.measured[n] += 0.001 * std::pow(markers(seen.channel(n), 0), 2);
    const auto found = nearer_to_measured(*model_, seen, truth_, solve_forward(*model_, seen, truth_, 1), 1);
    ASSERT_TRUE(found);
    const Points at = found->channels[1].topRows(seen.markers);
    EXPECT_LT((at - markers).rowwise().norm().maxCoeff(), 0.1);  // the same as without
}

}  // namespace
}  // namespace palpate::identify
