#include "identify/models/tool_path.h"

#include <gtest/gtest.h>

#include "tests/identify/bar_under_ball.h"

namespace palpate::identify {
namespace {

class PressedDeep : public testing::TestWithParam<bool>, public BarUnderBall {
protected:
    PressedDeep() {
        if (GetParam())
            model_ = std::make_unique<SkeletonBody>(body.chain(), body.markers, SmallBody::young, rig());
        else
            model_ = reference();
    }
    /// Of the marker in the middle of the upper side, above the ball [mm].
    double height(const Points& markers) const {
        Eigen::Index nearest = 0;
        const Eigen::RowVector3d under(30, 5, top);
        const Points rest = model_->observe(model_->rest(truth_.setting()), truth_.setting());
        (rest.rowwise() - under).rowwise().norm().minCoeff(&nearest);
        return markers(nearest, 2) - rest(nearest, 2);
    }

    std::unique_ptr<BodyModel> model_;
    Explanation truth_;
};

TEST_P(PressedDeep, StatesOfAProbeFollowTheTool) {
    truth_ = bare_truth(*model_, static_cast<int>(model_->laws().size()) - 1);
    std::vector<LoadState> states{LoadState{.probe = 0}};
    for (const double depth : {5.0, 10.0, 14.0, 18.5})
        states.push_back({.probe = 1, .time = depth, .motions = pressed(depth).motions});
    MeasurementSet set = body.set(std::move(states));
    set.tools = rig().tools;
    const Problem problem = make_problem(set, 1);
    const ForwardSolution forward = solve_forward(*model_, problem, truth_, 1);
    ASSERT_EQ(forward.q.size(), 5);
    double before = 0;
    for (int k = 1; k < 5; ++k) {
        const double now = height(forward.channels[k]);
        EXPECT_LT(now, before - 2) << k;
        EXPECT_LT(forward.channels[k](problem.markers, 2), 0) << k;  // the force on the body
        before = now;
    }
    // On its own the last of them tells of a ball that lifts the bar from below, where it is less far in.
    const Eigen::VectorXd alone = model_->equilibrium(truth_.setting(), pressed(18.5));
    EXPECT_GT(height(model_->observe(alone, truth_.setting())), 1);
}

class BodyPressedDeep : public PressedDeep {};

TEST_P(BodyPressedDeep, WhereItEndsDoesNotDependOnHowFarApartStatesAre) {
    truth_ = bare_truth(*model_, static_cast<int>(model_->laws().size()) - 1);
    const ModelSetting setting = truth_.setting();
    const PreparedRig prepared(rig());
    const Eigen::VectorXd begun = model_->equilibrium(setting, pressed(2));
    const Eigen::VectorXd at_once = equilibrium_after(*model_, prepared, setting, pressed(2), begun, pressed(10));
    Eigen::VectorXd in_steps = begun;
    for (double depth = 3; depth <= 10; ++depth)
        in_steps = equilibrium_after(*model_, prepared, setting, pressed(depth - 1), in_steps, pressed(depth));
    EXPECT_LT((at_once - in_steps).norm(), 1e-4 * in_steps.norm());
    EXPECT_LT(height(model_->observe(at_once, setting)), -5);
}

TEST(ToolPath, IsKnownWhereEveryToolWasBefore) {
    Action none, one, both;
    one.motions = {{.tool = 1}};
    both.motions = {{.tool = 0}, {.tool = 1}};
    EXPECT_TRUE(is_reached_from(both, one));
    EXPECT_TRUE(is_reached_from(one, one));
    EXPECT_FALSE(is_reached_from(one, both));
    EXPECT_FALSE(is_reached_from(none, one));
    EXPECT_FALSE(is_reached_from(one, none));
}

TEST(ToolPath, IsStraightAndLeavesFreeCoordinatesFree) {
    Action from, to;
    from.motions = {{.tool = 1, .translation = Vec3(9, 9, 9)},
                    {.tool = 0, .translation = Vec3(50, missing, 4), .rotation = Vec3(0, 0.1, 0)}};
    to.motions = {{.tool = 0, .translation = Vec3(54, 3, missing), .rotation = Vec3(0, 0.3, 0)}};
    const Action there = on_the_way(from, to, 0.75);
    ASSERT_EQ(there.motions.size(), 1);
    const mesh::ToolMotion& at = there.motions.front();
    EXPECT_EQ(at.tool, 0);
    EXPECT_DOUBLE_EQ(at.translation.x(), 53);
    EXPECT_EQ(at.translation.y(), 3);  // it was free before: where it came from is not known
    EXPECT_TRUE(std::isnan(at.translation.z()));
    EXPECT_DOUBLE_EQ(at.rotation.y(), 0.25);
}

TEST_P(PressedDeep, AFreeCoordinateStaysFreeOnTheWay) {
    truth_ = bare_truth(*model_, static_cast<int>(model_->laws().size()) - 1);
    const ModelSetting setting = truth_.setting();
    Action from = pressed(2), to = pressed(9);
    from.motions[0].rotation.setConstant(missing);  // a ball may turn: nothing resists
    to.motions[0].rotation.setConstant(missing);
    const Eigen::VectorXd begun = model_->equilibrium(setting, from);
    const Eigen::VectorXd turned = equilibrium_after(*model_, PreparedRig(rig()), setting, from, begun, to),
                          held = equilibrium_after(*model_, PreparedRig(rig()), setting, pressed(2), begun, pressed(9));
    EXPECT_LT((turned - held).norm(), 1e-4 * held.norm());
}

INSTANTIATE_TEST_SUITE_P(Model, BodyPressedDeep, testing::Values(false));
INSTANTIATE_TEST_SUITE_P(Models, PressedDeep, testing::Bool(),
                         [](const auto& which) { return which.param ? "skeleton" : "body"; });

}  // namespace
}  // namespace palpate::identify
