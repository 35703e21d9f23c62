// Rigid tools that press on the skin: equilibria are those of the model in skeleton/ under the same tool.

#include <gtest/gtest.h>

#include "fem/rig/tool_potential.h"
#include "mesh/errors.h"
#include "skeleton/model/link_modulus.h"
#include "skeleton/runtime/body.h"
#include "skeleton/statics/equilibrium.h"
#include "tests/messages.h"
#include "tests/skeleton/runtime/live_models.h"
#include "tests/skeleton/test_effects.h"

namespace palpate::runtime {
namespace {

// The model's solver stops at 1e-9 of the force, so about 1e-9 of the displacement; the runtime's at 1e-9 of a link.
constexpr double as_in_model = 1e-8;

/// A block with a skin, and where a ball just touches its top, between two vertices.
class LiveTools : public testing::Test {
protected:
    LiveTools() {
        give_skin(model_);
        const mesh::Box box = mesh::bounding_box(model_.surface.vertices);
        top_ = {0.7 * box.max.x() + 0.3 * box.min.x(), (box.min.y() + box.max.y()) / 2 + 1, box.max.z()};
    }
    Vec3 ball_within(double depth) const { return top_ + Vec3(0, 0, radius_ - depth); }

    /// As skeleton/ has it; its layer is as much stiffer as the body that a tool is told of.
    skeleton::Equilibrium expected(const mesh::Tool& tool, const mesh::ToolMotion& motion, double compliance) const {
        fem::Effects effects;
        effects.tools.push_back(std::make_shared<fem::ToolPotential>(
            std::make_shared<const fem::RigidTool>(tool), motion, skeleton::link_modulus(model_) / compliance));
        return skeleton::StaticsSolver(model_, effects).solve(skeleton::stiffness_vector(model_), {});
    }
    double apart(const Body& body, const skeleton::Equilibrium& other) const {
        double most = 0;
        for (int i = 0; i < body.sphere_count(); ++i)
            most = std::max(most, (body.position(i) - Vec3(other.state.x.row(i))).norm());
        return most;
    }
    double moved(const Body& body) const {
        double most = 0;
        for (int i = 0; i < body.sphere_count(); ++i)
            most = std::max(most, (body.position(i) - model_.spheres[static_cast<std::size_t>(i)].center).norm());
        return most;
    }

    skeleton::Model model_ = skeleton::testing::make_full_lattice({4, 3, 2});
    double radius_ = 6;
    Vec3 top_;
};

TEST_F(LiveTools, BallStandsInEquilibriumAsInTheModel) {
    const BodyOptions options{.tool_compliance = 0.05};
    Body body(model_, options);
    const int ball = body.add_ball(radius_);
    body.place_tool(ball, ball_within(1));
    body.equilibrium();
    const mesh::Tool same{.name = "ball", .shape = mesh::SphereShape{radius_}, .origin = ball_within(0)};
    EXPECT_GT(moved(body), 0.8);  // [mm], of the 1 mm that the ball goes in
    EXPECT_LT(apart(body, expected(same, {.translation = Vec3(0, 0, -1)}, options.tool_compliance)),
              as_in_model * moved(body));
    const ToolLoad load = body.tool_load(ball);
    EXPECT_LT(load.force.z(), 0);
    EXPECT_LT(load.moment.norm(), 1e-14 * radius_ * load.force.norm());  // all normals meet in the middle; rounding
}

TEST_F(LiveTools, PunchStandsInEquilibriumAsInTheModel) {
    const BodyOptions options{.tool_compliance = 0.05};
    Body body(model_, options);
    const int punch = body.add_punch(radius_, -Vec3::UnitZ());
    body.place_tool(punch, top_ - Vec3(0, 0, 0.5));
    body.equilibrium();
    const mesh::Tool same{.name = "punch", .shape = mesh::FlatShape{radius_}, .origin = top_};
    EXPECT_LT(apart(body, expected(same, {.translation = Vec3(0, 0, -0.5)}, options.tool_compliance)),
              as_in_model * moved(body));
    EXPECT_GT(body.tool_load(punch).moment.norm(), 0.9 * body.tool_load(punch).force.norm());  // 1 mm off the middle
}

TEST_F(LiveTools, WorkOfAToolIsTheBodysEnergy) {
    Body body(model_, {.tool_compliance = 0.02});
    const int ball = body.add_ball(radius_);
    const auto work_to = [&](double depth) {  // by Simpson's rule from the depth before
        body.place_tool(ball, ball_within(depth));
        body.equilibrium();
        return -body.tool_load(ball).force.z();
    };
    double work = 0, before = work_to(0);
    constexpr int intervals = 40;
    constexpr double h = 1.0 / intervals;
    for (int i = 0; i < intervals; ++i) {
        const double middle = work_to((i + 0.5) * h), after = work_to((i + 1) * h);
        work += h / 6 * (before + 4 * middle + after);
        before = after;
    }
    EXPECT_NEAR(body.energy().potential, work, 0.012 * work);  // the layer stores its share: 0.9 %
}

TEST_F(LiveTools, SkinIsShownOutsideOfTheBall) {
    Body body(model_);
    const int ball = body.add_ball(radius_);
    body.place_tool(ball, ball_within(2));
    body.equilibrium();
    int touching = 0;
    for (int v = 0; v < body.vertex_count(); ++v) {
        const Vec3 x = Eigen::Map<const Eigen::Vector3f>(body.skin().data() + 3L * v).cast<double>();
        const double away = (x - ball_within(2)).norm() - radius_;
        EXPECT_GT(away, -2e-6);  // three coordinates of up to 32 mm in single precision, half of 2^-19 mm each
        touching += away < 2e-6 ? 1 : 0;
    }
    EXPECT_GT(touching, 0);
}

TEST_F(LiveTools, SlidesOverTheSkinAsIfItHadBeenPlacedThere) {
    Body body(model_);
    const int ball = body.add_ball(radius_);
    for (int step = 0; step <= 12; ++step) {
        const Vec3 at = ball_within(0.8) + 0.9 * step * Vec3(-0.8, -0.6, 0);
        body.place_tool(ball, at);
        body.equilibrium();
        if (step % 4 != 0) continue;
        Body fresh(model_);
        const int there = fresh.add_ball(radius_);
        fresh.place_tool(there, at);
        fresh.equilibrium();
        const Vec3 force = fresh.tool_load(there).force;
        // equilibria to 1e-8 mm, of the 0.8 mm by which the ball presses in
        EXPECT_LT((body.tool_load(ball).force - force).norm(), 3e-8 * force.norm()) << step;
    }
}

TEST_F(LiveTools, StepsSettleInTheEquilibriumAndComeBack) {
    Body body(model_, {.damping_ratio = 1});
    const int ball = body.add_ball(radius_);
    for (int i = 1; i <= 400; ++i) {
        body.place_tool(ball, ball_within(std::min(1.0, 0.01 * i)));
        body.step_implicit(1e-3);
    }
    const Vec3 held = body.tool_load(ball).force;
    Body still(model_);
    still.place_tool(still.add_ball(radius_), ball_within(1));
    still.equilibrium();
    EXPECT_LT((held - still.tool_load(0).force).norm(), as_in_model * held.norm());

    body.lift_tool(ball);
    EXPECT_EQ(body.tool_load(ball).force, Vec3::Zero());
    for (int i = 0; i < 400; ++i) body.step_implicit(1e-3);
    EXPECT_LT(moved(body), 1e-12);  // [mm]: the motion has died away
}

TEST_F(LiveTools, TwoBallsSqueezeABodyThatIsPulledToo) {
    Body body(model_);
    const int above = body.add_ball(radius_), below = body.add_ball(radius_);
    const int contact = body.touch(model_.surface.vertices.row(100));
    body.drag(contact, body.place(contact) + Vec3(0, 2, 0), 0.5);
    const mesh::Box box = mesh::bounding_box(model_.surface.vertices);
    body.place_tool(above, ball_within(1));
    body.place_tool(below, Vec3(top_.x(), top_.y(), box.min.z() - radius_ + 1));
    body.equilibrium();
    const double up = body.tool_load(below).force.z(), down = body.tool_load(above).force.z();
    EXPECT_GT(up, 0);
    EXPECT_NEAR(up, -down, 0.04 * up);  // they press 1 mm each; the rest is what pull and support bear
}

class LiveActuation : public LiveTools {
protected:
    LiveActuation() {
        path_.resize(3, 3);
        const mesh::Box box = mesh::bounding_box(model_.surface.vertices);
        const double y = 0.6 * box.max.y() + 0.4 * box.min.y(), z = 0.8 * box.max.z() + 0.2 * box.min.z();
        path_ << box.min.x() - 5, y, z, (box.min.x() + box.max.x()) / 2, y, z, box.max.x() - 4, y, z;
    }
    skeleton::Equilibrium expected_under(double value, bool by_length) const {
        fem::Effects effects;
        effects.tendons.push_back(
            {.actuator = std::make_shared<const mesh::TendonActuator>(mesh::TendonActuator{path_, by_length}),
             .value = value,
             .young = skeleton::link_modulus(model_)});
        return skeleton::StaticsSolver(model_, effects).solve(skeleton::stiffness_vector(model_), {});
    }
    Points path_;
};

TEST_F(LiveActuation, TendonPullsAsInTheModel) {
    Body body(model_);
    const int tendon = body.add_tendon(path_);
    EXPECT_EQ(body.tendon_tension(tendon), 0);
    body.pull_tendon(tendon, 2);
    body.equilibrium();
    EXPECT_GT(moved(body), 0.5);  // [mm]: 0.7
    EXPECT_LT(apart(body, expected_under(2, false)), as_in_model * moved(body));
    EXPECT_EQ(body.tendon_tension(tendon), 2);
}

TEST_F(LiveActuation, TendonIsDrawnInAsInTheModelAndGoesSlack) {
    Body body(model_);
    const int tendon = body.add_tendon(path_);
    body.draw_tendon(tendon, 1);
    body.equilibrium();
    EXPECT_GT(moved(body), 1);  // [mm]: the tendon is drawn in by as much
    EXPECT_LT(apart(body, expected_under(1, true)), as_in_model * moved(body));
    const double tension = body.tendon_tension(tendon);
    EXPECT_GT(tension, 0);
    // The same tension does the same.
    const Vec3 tip = body.position(body.sphere_count() - 1);
    body.pull_tendon(tendon, tension);
    body.equilibrium();
    EXPECT_LT((body.position(body.sphere_count() - 1) - tip).norm(), as_in_model * moved(body));
    // Pulled further by a ball it slackens.
    body.draw_tendon(tendon, 0);
    body.place_tool(body.add_ball(radius_), Vec3(path_(2, 0) + 8, path_(2, 1), path_(2, 2)));
    body.equilibrium();
    EXPECT_EQ(body.tendon_tension(tendon), 0);
    body.let_tendon_go(tendon);
    body.reset();
    body.equilibrium();
    EXPECT_LT(moved(body), 3e-14);  // rounding of 30 mm
}

TEST_F(LiveActuation, PressureActsAsTheEffectDoes) {
    add_cavity(model_);
    Body body(model_);
    body.set_pressure(0.02);
    body.equilibrium();
    skeleton::Model with = model_;
    with.effects = {{"pressure", {{"pressure", 0.02, "MPa"}}}};
    EXPECT_GT(moved(body), 0.025);                                                           // [mm]: 0.031
    EXPECT_LT(apart(body, skeleton::equilibrium(with, {})), 3 * as_in_model * moved(body));  // a small displacement
    Body of_effect(with);
    of_effect.set_pressure(-0.02);  // both together are none
    of_effect.equilibrium();
    EXPECT_LT(moved(of_effect), 3e-14);  // rounding of 30 mm
}

TEST_F(LiveActuation, PressureActsInOneCavityAlone) {
    add_cavity(model_);
    const Vec3 first = model_.surface.vertices.bottomRows(1).transpose();
    const mesh::Box box = mesh::bounding_box(model_.surface.vertices);
    model_ = skeleton::testing::with_cavity(model_, {0.7 * box.max.x() + 0.3 * box.min.x(), first.y(), first.z()}, 1);
    const Vec3 second = model_.surface.vertices.bottomRows(1).transpose();
    Body body(model_);
    ASSERT_NE(body.find_cavity(first), body.find_cavity(second));
    for (const Vec3& at : {first, second}) {
        body.set_pressure(0);
        body.set_cavity_pressure(body.find_cavity(at), 0.05);
        body.equilibrium();
        fem::Effects effects;
        effects.cavities.push_back({std::make_shared<const mesh::PressureActuator>(mesh::PressureActuator{at}), 0.05});
        const skeleton::Equilibrium expected =
            skeleton::StaticsSolver(model_, effects).solve(skeleton::stiffness_vector(model_), {});
        EXPECT_GT(moved(body), 0.001);           // [mm]
        EXPECT_LT(apart(body, expected), 1e-8);  // 1e-9 of a link
    }
    body.set_pressure(0.05);  // in both
    body.equilibrium();
    skeleton::Model with = model_;
    with.effects = {{"pressure", {{"pressure", 0.05, "MPa"}}}};
    EXPECT_LT(apart(body, skeleton::equilibrium(with, {})), 1e-8);
    EXPECT_TRUE(says(message_of<InvalidInput>([&] { body.set_cavity_pressure(2, 1); }), {"cavity 2", "encloses 2"}));
    EXPECT_TRUE(says(message_of<InvalidInput>([&] { body.set_cavity_pressure(0, NAN); }), {"finite"}));
}

TEST_F(LiveActuation, RefusesWhatCannotBe) {
    Body body(model_);
    EXPECT_TRUE(says(message_of<InvalidInput>([&] { body.set_pressure(1); }), {"no cavity"}));
    EXPECT_TRUE(says(message_of<InvalidInput>([&] { body.find_cavity(top_); }), {"no cavity"}));
    EXPECT_TRUE(says(message_of<InvalidInput>([&] { body.set_cavity_pressure(0, 1); }), {"no cavity"}));
    body.equilibrium();  // and nothing has changed
    EXPECT_TRUE(says(message_of<InvalidInput>([&] { body.add_tendon(path_.topRows(1)); }), {"1 points", "2 or more"}));
    const Points twice = path_({0, 1, 1}, Eigen::all);
    EXPECT_TRUE(says(message_of<InvalidInput>([&] { body.add_tendon(twice); }), {"points 2 and 3", "one place"}));
    EXPECT_TRUE(says(message_of<InvalidInput>([&] { body.pull_tendon(0, 1); }), {"tendon 0", "add_tendon"}));
    const int tendon = body.add_tendon(path_);
    EXPECT_TRUE(says(message_of<InvalidInput>([&] { body.pull_tendon(tendon, -1); }), {"-1", "at least 0"}));
}

TEST_F(LiveTools, RefuseWhatCannotBe) {
    Body body(model_);
    EXPECT_TRUE(says(message_of<InvalidInput>([&] { body.add_ball(0); }), {"radius", "0"}));
    EXPECT_TRUE(says(message_of<InvalidInput>([&] { body.add_punch(1, Vec3::Zero()); }), {"axis", "0"}));
    EXPECT_TRUE(says(message_of<InvalidInput>([&] { body.place_tool(0, top_); }), {"tool 0", "add_ball"}));
    const int ball = body.add_ball(1);
    EXPECT_TRUE(says(message_of<InvalidInput>([&] { body.place_tool(ball, Vec3::Constant(NAN)); }), {"not finite"}));
    EXPECT_TRUE(says(message_of<InvalidInput>([&] { body.place_tool(ball, top_, Eigen::Quaterniond(0, 0, 0, 0)); }),
                     {"quaternion", "above 0"}));
    body.place_tool(ball, top_);
    EXPECT_TRUE(says(message_of<InvalidInput>([&] { body.step_explicit(1e-6); }), {"explicit", "step_implicit"}));
    body.reset();
    body.step_explicit(1e-6);  // it is away again
    EXPECT_TRUE(says(message_of<InvalidInput>([] { BodyOptions{.tool_compliance = 20}.validate(); }),
                     {"tool_compliance", "20", "1e-4 to 10"}));
    skeleton::Model bare = skeleton::testing::make_full_lattice({3, 2, 2});
    EXPECT_THROW(Body(bare).add_ball(1), InvalidInput);
}

}  // namespace
}  // namespace palpate::runtime
