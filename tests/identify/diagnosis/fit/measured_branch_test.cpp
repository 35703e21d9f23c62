#include "identify/diagnosis/fit/measured_branch.h"

#include <gtest/gtest.h>

#include "identify/diagnosis/fit/refit.h"
#include "identify/models/tool_path.h"
#include "tests/identify/small_body.h"

namespace palpate::identify {
namespace {

/// A ball that has pressed the bar down by more than its thickness, of which only the last pose is told: it might as
/// well have lifted the bar from below.
class PressedOutOfSight : public testing::Test {
protected:
    static constexpr double noise = 0.02;  // [mm]
    static Rig rig() {
        return {{{.name = "ball", .shape = mesh::SphereShape{8}, .bonded = false, .origin = Vec3(30, 5, -60)}}, {}};
    }
    static Action pressed(double depth) {
        Action action;
        action.motions = {{.tool = 0, .translation = Vec3(0, 0, 78 - depth)}};
        return action;
    }
    PressedOutOfSight() {
        body_.mesh = mesh::to_quadratic(mesh::make_bar(Vec3::Zero(), Vec3(40, 10, 10), {8, 2, 2}));
        model_ =
            std::make_unique<ReferenceBody>(body_.mesh, body_.supports, body_.markers,
                                            ReferenceBodyOptions{.young = 0.1, .measured_on_mesh = true, .rig = rig()});
        truth_ = bare_truth(*model_, 2);
        const ModelSetting setting = truth_.setting();
        pressed_ = model_->equilibrium(setting, pressed(5));
        for (const auto& [from, to] : {std::pair{5.0, 10.0}, {10.0, 14.0}, {14.0, depth_}})
            pressed_ = equilibrium_after(*model_, PreparedRig(rig()), setting, pressed(from), pressed_, pressed(to));
    }
    /// Its readings where the bar stands so.
    Problem problem(const Eigen::VectorXd& q) const {
        MeasurementSet set =
            body_.set({LoadState{.probe = 0}, {.probe = 1, .time = 1, .motions = pressed(depth_).motions}});
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

    double depth_ = 18.5;
    SmallBody body_;
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
