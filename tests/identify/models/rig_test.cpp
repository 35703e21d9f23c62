#include "identify/models/rig.h"

#include <gtest/gtest.h>

#include "mesh/errors.h"
#include "tests/identify/models/rig_laws.h"
#include "tests/messages.h"

// Laws of tools and actuators on every model of a body.

namespace palpate::identify::rigs {

TEST_P(RigLaws, NetForcesVanishInEquilibrium) {
    for (const NamedAction& named : actions()) {
        const std::string& name = named.name;
        const Action& action = named.action;
        const Eigen::VectorXd q = model_->equilibrium(setting_, action);
        // Solvers stop at 1e-7 of forces or better, free coordinates at 1e-6.
        EXPECT_LT(at_free(model_->residual(q, setting_, action)).norm(), 1e-5 * force_at_support(q, action)) << name;
        EXPECT_GT((model_->observe(q, setting_) - model_->observe(model_->rest(setting_), setting_)).norm(), 1) << name;
    }
}

TEST_P(RigLaws, TangentIsMinusTheDerivativeOfTheResidual) {
    for (const NamedAction& named : actions()) {
        const std::string& name = named.name;
        const Action& action = named.action;
        const Eigen::VectorXd q = model_->equilibrium(setting_, action);
        const auto tangent = model_->tangent(q, setting_, action);
        const auto residual = [&](const Eigen::VectorXd& at) {
            return at_free(model_->residual(at, setting_, action));
        };
        for (unsigned seed = 1; seed < 3; ++seed) {
            const Eigen::VectorXd step = random_step(seed);
            const Eigen::VectorXd J = at_free(model_->tangent_times(q, setting_, action, step));
            // Differences of step 1e-7 carry six digits; free coordinates are found to eight of their forces.
            EXPECT_LT((J + along(residual, q, step, 1e-7)).norm(), 1e-4 * J.norm()) << name;
            // Rounding times the condition, of up to 1e9 between springs and links.
            EXPECT_LT((tangent->solve(J) - step).norm(), 1e-5 * step.norm()) << name;
        }
    }
}

TEST_P(RigLaws, ReactionSlopesAreDerivatives) {
    for (const NamedAction& named : actions()) {
        const std::string& name = named.name;
        const Action& action = named.action;
        if (action.motions.empty()) continue;
        const Eigen::VectorXd q = model_->equilibrium(setting_, action);
        const ReactionSlopes slopes = model_->reaction_slopes(q, setting_, action);
        const auto reactions = [&](const Eigen::VectorXd& at) { return model_->reactions(at, setting_, action); };
        EXPECT_GT(reactions(q).norm(), 0) << name;
        const Eigen::VectorXd step = random_step(5), expected = slopes.by_step * step;
        EXPECT_LT((along(reactions, q, step, 1e-7) - expected).norm(), 1e-4 * expected.norm()) << name;  // as above

        const auto by_theta = [&](Eigen::Index k, double h) {
            ModelSetting other = setting_;
            other.theta[k] += h;
            return model_->reactions(q, other, action);
        };
        for (Eigen::Index k = 0; k < setting_.theta.size(); ++k) {
            // Stiff springs leave eight digits of a reaction, differences of step 1e-3 five of those, free coordinates
            // four.
            EXPECT_LT(((by_theta(k, 1e-3) - by_theta(k, -1e-3)) / 2e-3 - slopes.by_parameter.col(k)).norm(),
                      1e-3 * reactions(q).norm())
                << name;
        }
        if (action.motions[0].translation.hasNaN()) continue;
        const auto by_pose = [&](int c, double h) {
            Action other = action;
            other.motions[0].translation[c] += h;
            return model_->reactions(q, setting_, other);
        };
        for (int c = 0; c < 3; ++c) {
            EXPECT_LT(((by_pose(c, 1e-7) - by_pose(c, -1e-7)) / 2e-7 - slopes.by_pose.col(c)).norm(),
                      1e-4 * slopes.by_pose.norm())
                << name;
        }
    }
}

TEST_P(RigLaws, SignaturesAreDerivativesOfTheResidual) {
    for (const NamedAction& named : actions()) {
        const std::string& name = named.name;
        const Action& action = named.action;
        const Eigen::VectorXd q = model_->equilibrium(setting_, action);
        const Eigen::MatrixXd G = model_->parameter_force(q, setting_, action);
        const double scale = G.norm() + force_at_support(q, action);
        for (Eigen::Index k = 0; k < setting_.theta.size(); ++k) {
            const auto residual = [&](double h) {
                ModelSetting other = setting_;
                other.theta[k] += h;
                return model_->residual(q, other, action);
            };
            EXPECT_LT(((residual(1e-3) - residual(-1e-3)) / 2e-3 - G.col(k)).norm(), 1e-4 * scale)
                << name << k;  // as above
        }
        const Eigen::MatrixXd A = model_->actuation_force(q, setting_, action);
        for (std::size_t a = 0; a < action.settings.size(); ++a) {
            const auto residual = [&](double h) {
                Action other = action;
                other.settings[a].value += h;
                return model_->residual(q, setting_, other);
            };
            const Eigen::VectorXd column = A.col(static_cast<Eigen::Index>(a));
            // A slack cable does not answer.
            EXPECT_LE(((residual(1e-6) - residual(-1e-6)) / 2e-6 - column).norm(), 1e-5 * column.norm()) << name << a;
        }
    }
}

TEST_P(RigLaws, MotionsAloneTellNothingOfStiffnessAndReactionsAllOfIt) {
    for (const NamedAction& named : of({"ball", "grip", "grip that turns"})) {
        const std::string& name = named.name;
        const Action& action = named.action;
        const Eigen::VectorXd q = model_->equilibrium(setting_, action);
        const Eigen::VectorXd W = model_->reactions(q, setting_, action);
        // All of the body is twice as stiff.
        ModelSetting stiffer = setting_;
        Eigen::VectorXd way = Eigen::VectorXd::Zero(setting_.theta.size());
        for (Eigen::Index k = 0; k < way.size(); ++k) way[k] = model_->parameters()[k].stiffens ? 1 : 0;
        stiffer.theta += std::log(2) * way;
        const Eigen::VectorXd again = model_->equilibrium(stiffer, action);
        EXPECT_LT((model_->observe(again, stiffer) - model_->observe(q, setting_)).norm(), 1e-3) << name;  // [mm]
        EXPECT_LT((model_->reactions(again, stiffer, action) - 2 * W).norm(), 1e-3 * W.norm()) << name;
        // And by the slopes: dW/d ln E = by_parameter + by_step J^-1 g.
        const Eigen::VectorXd g = model_->parameter_force(q, setting_, action) * way;
        const ReactionSlopes slopes = model_->reaction_slopes(q, setting_, action);
        const Eigen::VectorXd dW =
            slopes.by_parameter * way + slopes.by_step * model_->tangent(q, setting_, action)->solve(g);
        EXPECT_LT((dW - W).norm(), 1e-3 * W.norm()) << name;  // what is not balanced, through stiff springs
    }
}

TEST_P(RigLaws, SupportsBearWhatToolsExert) {
    // Without the cable, whose guide stands in space and bears a part.
    Rig rig = rig_of_bar();
    rig.actuators.clear();
    model_ = model(rig);
    for (const NamedAction& named : of({"ball", "grip", "punch that shifts"})) {
        const std::string& name = named.name;
        const Action& action = named.action;
        const Eigen::VectorXd q = model_->equilibrium(setting_, action);
        const Eigen::VectorXd W = model_->reactions(q, setting_, action);
        const Eigen::MatrixXd S = model_->support_motion(Vec3::Zero());
        const Vec3 support = -(S.transpose() * model_->residual(q, setting_, action)).head<3>();
        // As far as an equilibrium balances.
        EXPECT_LT((support + W.head<3>()).norm(), 1e-4 * W.head<3>().norm()) << name;
    }
}

INSTANTIATE_TEST_SUITE_P(All, RigLaws,
                         testing::Values(RigCase{"ReferenceLinear", false, 0}, RigCase{"ReferenceSvk", false, 1},
                                         RigCase{"ReferenceNeoHooke", false, 2}, RigCase{"SkeletonLinear", true, 0},
                                         RigCase{"SkeletonLargeRotation", true, 1},
                                         RigCase{"ReferenceLinearRubs", false, 0, 0.4},
                                         RigCase{"ReferenceNeoHookeRubs", false, 2, 0.4},
                                         RigCase{"SkeletonLinearRubs", true, 0, 0.4},
                                         RigCase{"SkeletonLargeRotationRubs", true, 1, 0.4}),
                         [](const auto& each) { return each.param.name; });

TEST(RigOnBody, ALinearSkeletonRefusesWhatParts) {
    const SmallBody body = SmallBody::hollow();
    const SkeletonBody model(body.chain(), body.markers, SmallBody::young, rig_of_bar());
    const ModelSetting setting{0, Eigen::Vector3d::Zero(), {}};
    Action pressed;
    pressed.motions = {{ball, Vec3(0, 0, -1), Vec3::Zero()}};
    EXPECT_TRUE(says(message_of<SolverFailure>([&] { model.equilibrium(setting, pressed); }),
                     {"\"ball\"", "linear law", "large-rotation"}));
}

}  // namespace palpate::identify::rigs
