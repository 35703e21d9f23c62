#include "identify/models/free_tools.h"

#include <gtest/gtest.h>

#include "tests/identify/models/rig_laws.h"

namespace palpate::identify::rigs {

TEST_P(RigLaws, NothingPushesAlongFreeCoordinates) {
    for (const NamedAction& named : of({"grip that turns", "punch that shifts"})) {
        const std::string& name = named.name;
        const Action& action = named.action;
        const Eigen::VectorXd q = model_->equilibrium(setting_, action);
        const std::vector<mesh::ToolMotion> found = model_->motions(q, setting_, action);
        const Eigen::VectorXd W = model_->reactions(q, setting_, action);
        ASSERT_EQ(found.size(), 1u);
        const bool shifts = name == "punch that shifts";
        const Eigen::VectorXd free =
            shifts ? Eigen::VectorXd(W(std::vector{0, 1, 4})) : Eigen::VectorXd(W(std::vector{0, 3, 4, 5}));
        EXPECT_LT(free.norm(), 1e-5 * W.norm()) << name;  // as found
        EXPECT_EQ(found[0].translation.z(), action.motions[0].translation.z());
        EXPECT_TRUE(found[0].translation.allFinite() && found[0].rotation.allFinite());
        EXPECT_GT(found[0].rotation.norm(), 1e-3) << name;
        // Imposed, they leave all as it is.
        Action imposed = action;
        imposed.motions = found;
        const Eigen::VectorXd same = model_->equilibrium(setting_, imposed);
        EXPECT_LT((model_->observe(same, setting_) - model_->observe(q, setting_)).norm(), 1e-4) << name;
    }
}

TEST_P(RigLaws, APlatenThatMayTiltLiesFlat) {
    if (GetParam().is_skeleton && GetParam().law == 0) return;  // it refuses what parts
    const Action action = moved({platen, Vec3(0, 0, -1.5), Vec3(none, none, 0)});
    const Eigen::VectorXd q = model_->equilibrium(setting_, action);
    const Eigen::VectorXd W = model_->reactions(q, setting_, action);
    EXPECT_LT(W(2), 0);
    EXPECT_LT(W.segment<2>(3).norm(), 1e-5 * W.norm());  // as free coordinates are found
    // The bar sinks ahead of its support: the platen's outer edge goes down with it, a turn about y.
    EXPECT_GT(model_->motions(q, setting_, action)[0].rotation.y(), 0.01);
}

TEST(RigOnBody, AFreeToolThatTouchesNothingStaysWhereItIs) {
    // Nothing touches the ball: it stays where it is told to be, its free coordinates as at rest.
    const SmallBody body = SmallBody::hollow();
    const ReferenceBody model(body.mesh, body.supports, body.markers, {.young = 0.1, .rig = rig_of_bar()});
    const ModelSetting setting{2, Eigen::Vector2d(-1, -2), {}};
    Action away;
    away.motions = {{ball, Vec3(none, 0, 1), Vec3::Zero()}};
    EXPECT_EQ(model.equilibrium(setting, away), model.rest(setting));
    EXPECT_EQ(model.motions(model.rest(setting), setting, away)[0].translation, Vec3(0, 0, 1));
    EXPECT_FALSE(model.discretisation_error(model.rest(setting), setting, away,
                                            *model.tangent(model.rest(setting), setting, {})));
}

}  // namespace palpate::identify::rigs
