#include "identify/models/rig.h"

#include <gtest/gtest.h>

#include <random>

#include "identify/models/reference/reference_body.h"
#include "identify/models/skeleton/skeleton_body.h"
#include "mesh/errors.h"
#include "tests/identify/small_body.h"
#include "tests/messages.h"

// Laws of tools and actuators on every model of a body.

namespace palpate::identify {
namespace {

constexpr double none = NAN;  // a coordinate that is left free
constexpr int ball = 0, grip = 1, punch = 2, platen = 3;
constexpr int pull = 0, cable = 1, chamber = 2;

Rig rig_of_bar() {
    const auto tendon = [](double y, double z, bool by_length) {
        Points path(4, 3);
        path << 0, y, z, 12, y, z - 1, 24, y, z + 0.5, 36, y, z;
        return mesh::TendonActuator{path, by_length};
    };
    const Vec3 end(40, 5, 5);
    return {
        {{.name = "ball", .shape = mesh::SphereShape{8}, .bonded = false, .origin = Vec3(25, 5, 18)},
         {.name = "grip",
          .shape = mesh::GripShape{{mesh::BoxRegion{Vec3(39, -1, -1), Vec3(41, 11, 11)}}},
          .bonded = true,
          .origin = end},
         {.name = "punch", .shape = mesh::FlatShape{8, Vec3(0, 0, -1)}, .bonded = true, .origin = Vec3(20, 5, 10)},
         {.name = "platen", .shape = mesh::FlatShape{9, Vec3(0, 0, -1)}, .bonded = false, .origin = Vec3(22, 5, 10)}},
        {{.name = "pull", .kind = tendon(5, 8, false)},
         {.name = "cable", .kind = tendon(8, 5, true)},
         {.name = "chamber", .kind = mesh::PressureActuator{Vec3(20, 5, 5)}}}};
}

struct RigCase {
    std::string name;
    bool is_skeleton;
    int law;
    double friction = 0;  // of the tendons
};

struct NamedAction {
    std::string name;
    Action action;
};

class RigLaws : public testing::TestWithParam<RigCase> {
protected:
    RigLaws() {
        model_ = model(rig_of_bar());
        setting_.law = GetParam().law;
        setting_.effects.tendon_friction = GetParam().friction;
        setting_.theta.resize(std::ssize(model_->parameters()));
        for (Eigen::Index k = 0; k < setting_.theta.size(); ++k)
            setting_.theta[k] = model_->parameters()[k].start + 0.1;
    }

    std::unique_ptr<BodyModel> model(const Rig& rig) const {
        if (GetParam().is_skeleton)
            return std::make_unique<SkeletonBody>(body_.chain(), body_.markers, SmallBody::young, rig);
        return std::make_unique<ReferenceBody>(
            body_.mesh, body_.supports, body_.markers,
            ReferenceBodyOptions{.young = 0.1, .measured_on_mesh = true, .rig = rig});
    }

    static Action moved(const mesh::ToolMotion& motion, const std::vector<mesh::ActuatorSetting>& settings = {}) {
        Action action;
        action.motions = {motion};
        action.settings = settings;
        return action;
    }
    static std::vector<NamedAction> actions() {
        Action filled, back;
        filled.gravity = Vec3(0, 0, -2000);
        filled.settings = {{pull, 0.2}, {cable, 0.8}, {chamber, 0.01}};
        back.gravity = Vec3(0, 0, -2000);
        back.settings = {{pull, 0.1, {0.105}}, {cable, 0.6, {1}}};
        std::vector<NamedAction> all{
            {"grip", moved({grip, Vec3(-0.5, 1, -3), Vec3(0.05, 0.12, 0)})},
            {"grip that turns", moved({grip, Vec3(none, 1, -3), Vec3(none, none, none)})},
            {"punch and tendons", moved({punch, Vec3(0.2, 0.5, -1), Vec3(0, 0.03, 0)}, {{pull, 0.1}, {cable, 0.3}})},
            {"punch that shifts", moved({punch, Vec3(none, none, -1), Vec3(0, none, 0)})},
            {"chamber, weight and tendons", filled},
            // one sticks behind its turns, the other one slides back
            {"tendons on their way back", back}};
        // The linear law of a skeleton takes effects as they are at rest: nothing parts.
        if (!GetParam().is_skeleton || GetParam().law != 0)
            all.push_back({"ball", moved({ball, Vec3(0.2, 0.1, -1.5), Vec3::Zero()})});
        return all;
    }
    static std::vector<NamedAction> of(const std::vector<std::string>& names) {
        std::vector<NamedAction> some = actions();
        std::erase_if(some, [&](const NamedAction& one) { return std::ranges::find(names, one.name) == names.end(); });
        return some;
    }

    Eigen::ArrayX<bool> held() const { return model_->support_motion(Vec3::Zero()).rowwise().norm().array() > 0; }
    Eigen::VectorXd at_free(Eigen::VectorXd r) const {
        const Eigen::ArrayX<bool> fixed = held();
        for (Eigen::Index k = 0; k < r.size(); ++k)
            if (fixed[k]) r[k] = 0;
        return r;
    }
    Eigen::VectorXd random_step(unsigned seed) const {
        std::mt19937_64 engine(seed);
        std::uniform_real_distribution<double> uniform(-1, 1);
        return at_free(Eigen::VectorXd::NullaryExpr(model_->dofs(), [&] { return uniform(engine); }));
    }
    /// d f(advance(q, s step)) / d s by central differences.
    template <class F>
    Eigen::VectorXd along(const F& f, const Eigen::VectorXd& q, const Eigen::VectorXd& step, double h) const {
        return (f(model_->advance(q, h * step, setting_)) - f(model_->advance(q, -h * step, setting_))) / (2 * h);
    }
    /// The largest force that holds the body in place.
    double force_at_support(const Eigen::VectorXd& q, const Action& action) const {
        const Eigen::VectorXd r = model_->residual(q, setting_, action);
        return (r - at_free(r)).norm();
    }

    SmallBody body_ = SmallBody::hollow();
    std::unique_ptr<BodyModel> model_;
    ModelSetting setting_;
};

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

INSTANTIATE_TEST_SUITE_P(All, RigLaws,
                         testing::Values(RigCase{"ReferenceLinear", false, 0}, RigCase{"ReferenceSvk", false, 1},
                                         RigCase{"ReferenceNeoHooke", false, 2}, RigCase{"SkeletonLinear", true, 0},
                                         RigCase{"SkeletonLargeRotation", true, 1},
                                         RigCase{"ReferenceLinearRubs", false, 0, 0.4},
                                         RigCase{"ReferenceNeoHookeRubs", false, 2, 0.4},
                                         RigCase{"SkeletonLinearRubs", true, 0, 0.4},
                                         RigCase{"SkeletonLargeRotationRubs", true, 1, 0.4}),
                         [](const auto& each) { return each.param.name; });

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

TEST(RigOnBody, ALinearSkeletonRefusesWhatParts) {
    const SmallBody body = SmallBody::hollow();
    const SkeletonBody model(body.chain(), body.markers, SmallBody::young, rig_of_bar());
    const ModelSetting setting{0, Eigen::Vector3d::Zero(), {}};
    Action pressed;
    pressed.motions = {{ball, Vec3(0, 0, -1), Vec3::Zero()}};
    EXPECT_TRUE(says(message_of<SolverFailure>([&] { model.equilibrium(setting, pressed); }),
                     {"\"ball\"", "linear law", "large-rotation"}));
}

}  // namespace
}  // namespace palpate::identify
