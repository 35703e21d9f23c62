#include "identify/diagnosis/likelihood/tool_prints.h"

#include "identify/diagnosis/likelihood/reading_weights.h"
#include "identify/diagnosis/likelihood/tool_nuisances.h"
#include "identify/effects/catalogue.h"
#include "tests/identify/diagnosed.h"

namespace palpate::identify {
namespace {

/// The bar pressed by a ball from above, near its middle.
class UnderABall : public Diagnosed {
protected:
    UnderABall() {
        body_.mesh = mesh::to_quadratic(mesh::make_bar(Vec3::Zero(), Vec3(40, 10, 10), {16, 4, 4}));
        press_at(20);
    }
    void press_at(double x) {
        rig_.tools = {{.name = "ball", .shape = mesh::SphereShape{4}, .origin = Vec3(x, 5, 14)}};
        model_ =
            std::make_unique<ReferenceBody>(body_.mesh, body_.supports, body_.markers,
                                            ReferenceBodyOptions{.young = 0.1, .measured_on_mesh = true, .rig = rig_});
        LoadState state{.probe = 1, .time = 1};
        state.motions = {{.tool = 0, .translation = Vec3(0, 0, -1)}};
        state.reactions = {{.tool = 0, .force = Vec3::Zero()}};
        MeasurementSet set = body_.set({LoadState{.probe = 0}, state});
        set.tools = rig_.tools;
        set.reaction_noise = 1e-4;
        problem_ = make_problem(make_twin(*model_, set, truth(), sigma), sigma);
        forward_ = solve_forward(*model_, problem_, truth(), 1);
    }
    int pressed() const { return problem_.loaded(0) ? 0 : 1; }

    Rig rig_;
    Problem problem_;
    ForwardSolution forward_;
};

TEST_F(UnderABall, IsWhereAndAsLargeAsTheContact) {
    const ModelSetting setting = truth().setting();
    EXPECT_TRUE(tool_prints(*model_, problem_, setting, forward_, 1 - pressed()).empty());
    const std::vector<ToolPrint> prints = tool_prints(*model_, problem_, setting, forward_, pressed());
    ASSERT_EQ(prints.size(), 1U);
    EXPECT_LT((prints[0].contact.point - Vec3(20, 5, 10)).norm(), 1.3);  // half the 2.5 mm between the skin's points
    EXPECT_LT(prints[0].contact.radius, 4);                              // the ball's
    EXPECT_GT(prints[0].contact.radius, 0.5);                            // the bar sinks away from it, as it bends
    const Vec3 felt = forward_.channels[static_cast<std::size_t>(pressed())].row(problem_.markers);
    EXPECT_EQ(prints[0].contact.force, felt);
    EXPECT_LT(felt.z(), 0);
    // The ball came 1 mm from where it just touched; what stands between the points of the skin it reaches first.
    EXPECT_LT(prints[0].stroke, 1.05);
    EXPECT_GT(prints[0].stroke, 0.7);
}

TEST_F(UnderABall, PlayIsAShareOfHowFarItPresses) {
    const ModelSetting setting = truth().setting();
    const double stroke = tool_prints(*model_, problem_, setting, forward_, pressed()).front().stroke;
    // The same tool brought from afar to where it presses: the same columns.
    const auto play_of = [&](const Vec3& origin) {
        Problem problem = problem_;
        auto rig = std::make_shared<Rig>(*problem.rig);
        const Vec3 off = rig->tools[0].origin - origin;
        rig->tools[0].origin = origin;
        problem.rig = rig;
        const ReferenceBody model(body_.mesh, body_.supports, body_.markers,
                                  {.young = 0.1, .measured_on_mesh = true, .rig = *rig});
        ForwardSolution forward = forward_;
        for (Action& action : forward.actions)
            for (mesh::ToolMotion& motion : action.motions) motion.translation += off;
        const ToolNuisances tools = tool_nuisances(model, problem, setting, forward);
        return tools.signatures.in_action(pressed(), forward.q[pressed()]);
    };
    const Signatures::InAction near = play_of(Vec3(20, 5, 14)), far = play_of(Vec3(20, 5, 94));
    EXPECT_LT((near.reactions - far.reactions).norm(), 1e-9 * near.reactions.norm());
    // By its whole stroke less it would not touch: the slope of its force times that is more than its force.
    const Vec3 felt = forward_.channels[static_cast<std::size_t>(pressed())].row(problem_.markers);
    EXPECT_GT(stroke, 0);
    EXPECT_LT(near.reactions.col(0).head<3>().dot(felt), 0);
}

TEST_F(UnderABall, DoesNotSlipByAShareOfItsWayOverTheBody) {
    const auto slip = find_effect("slip");
    EXPECT_EQ(slip->numbers(*model_, problem_).size(), 1U);
    Problem roaming = problem_;
    for (Stage& stage : roaming.stages)
        for (mesh::ToolMotion& motion : stage.action.motions) motion.translation.x() += 5;  // the ball's radius is 4
    EXPECT_TRUE(slip->numbers(*model_, roaming).empty());
}

TEST_F(UnderABall, ItsForceHasAGainOfItsOwnNextToASupport) {
    const auto gains = [&] {
        const Nuisances all = make_nuisances(*model_, problem_, truth(), forward_, 1);
        std::vector<Eigen::Index> found;
        for (std::size_t i = 0; i < all.names.size(); ++i)
            if (all.names[i].starts_with("gain next to the support")) found.push_back(static_cast<Eigen::Index>(i));
        return std::pair(all, found);
    };
    EXPECT_TRUE(gains().second.empty()) << "half the bar away from it";
    press_at(1);
    const auto [all, found] = gains();
    ASSERT_EQ(found.size(), 1U);
    EXPECT_NEAR(all.precisions[found[0]], 1 / std::pow(NuisanceOptions{}.gain_at_support, 2), 1e-9);
    const Eigen::VectorXd column = all.columns.col(found[0]), felt = problem_.pick(forward_.markers);
    for (Eigen::Index n = 0; n < problem_.rows(); ++n) {
        const bool counts = problem_.action[n] == pressed() && !problem_.is_position(n);
        EXPECT_EQ(column[n], counts ? felt[n] / problem_.sigma[n] : 0);
    }
}

TEST_F(UnderABall, MakesMarkersNextToItCountForLess) {
    const NuisanceOptions dents_alone{.ragged = 0};
    const Eigen::VectorXd weights = reading_weights(*model_, problem_, truth(), forward_, dents_alone);
    double near = 1, far = 0;
    for (Eigen::Index n = 0; n < problem_.rows(); ++n) {
        if (!problem_.is_position(n)) continue;
        if (problem_.action[n] != pressed()) {
            EXPECT_EQ(weights[n], 1);
            continue;
        }
        const double away = (problem_.rest.row(problem_.channel(n)).transpose() - Vec3(20, 5, 10)).norm();
        if (away < 4) near = std::min(near, weights[n]);
        if (away > 15) far = std::max(far, weights[n]);
    }
    EXPECT_LT(near, far);
    EXPECT_LT(near, 1);
}

}  // namespace
}  // namespace palpate::identify
