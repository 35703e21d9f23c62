// Laws of motion: energy, momenta, stability, and a pendulum that is known.

#include <gtest/gtest.h>

#include <numbers>

#include "mesh/errors.h"
#include "skeleton/runtime/body.h"
#include "tests/messages.h"
#include "tests/skeleton/runtime/live_models.h"

namespace palpate::runtime {
namespace {

using skeleton::testing::make_chain;
using skeleton::testing::make_full_lattice;
using skeleton::testing::make_lattice;

skeleton::Model let_go(skeleton::Model model) {
    std::mt19937_64 engine(2);
    for (skeleton::Sphere& sphere : model.spheres) {
        sphere.held = false;
        // an inertia that is not round, of a body that could be
        const Vec3 spread = Vec3(1, 2, 3) + skeleton::testing::random_vector(engine, 0.5);
        const Mat3 R = skeleton::rotation(skeleton::testing::random_vector(engine, 3));
        const Vec3 moments = spread.sum() - spread.array();
        sphere.inertia = 1e-6 * (R * moments.asDiagonal() * R.transpose());
    }
    return model;
}

void set_off(Body& body, double speed, double spin) {
    std::mt19937_64 engine(4);
    for (int i = 0; i < body.sphere_count(); ++i) {
        body.set_velocity(i, skeleton::testing::random_vector(engine, speed),
                          skeleton::testing::random_vector(engine, spin));
    }
}

TEST(LiveMotion, AFreeBodyKeepsItsMomentaAndEnergyIsBounded) {
    for (const skeleton::Model& model : {let_go(make_lattice({3, 2, 2})), let_go(make_full_lattice({3, 2, 2}))}) {
        Body body(model, {.damping_ratio = 0});
        set_off(body, 2000, 300);
        const Momenta before = body.momenta();
        const Energy start = body.energy();
        const double total = start.kinetic + start.potential;
        const double h = 0.1 * body.stable_step();
        double most = 0;
        for (int i = 0; i < 100; ++i) {
            body.step_explicit(h, 200);
            const Energy now = body.energy();
            most = std::max(most, std::abs(now.kinetic + now.potential - total) / total);
        }
        // The energy of a mode swings by (omega h)^2 / 4, 1 % for the stiffest at a tenth of the stable step
        // (omega h = 0.2), and does not drift; a random start has most of its energy in softer ones (0.05 % in all).
        EXPECT_LT(most, 1e-3);
        // About a half, by equipartition; which moment of a chaotic motion this is, rounding decides.
        EXPECT_GT(body.energy().potential, 0.25 * total);
        const Momenta after = body.momenta();
        // 20,000 steps of rounding at random, each 1e-16 of what single spheres have
        EXPECT_LT((after.linear - before.linear).norm(), 1e-13 * before.linear.norm());
        EXPECT_LT((after.angular - before.angular).norm(), 1e-13 * before.angular.norm());
    }
}

TEST(LiveMotion, TheExplicitRuleIsOfSecondOrder) {
    const skeleton::Model model = make_full_lattice({3, 2, 2});
    const auto end = [&](int steps) {
        Body body(model, {.damping_ratio = 0});
        set_off(body, 500, 50);
        body.step_explicit(2e-3 / steps, steps);
        return body.position(11);
    };
    const Vec3 reference = end(64000);
    const double coarse = (end(2000) - reference).norm(), fine = (end(4000) - reference).norm();
    // Of second order is (1/2000^2 - 1/64000^2) / (1/4000^2 - 1/64000^2); the rest is of fourth order.
    EXPECT_NEAR(coarse / fine, 4 * (1 - 1 / 1024.0) / (1 - 1 / 256.0), 0.002);
}

TEST(LiveMotion, TheImplicitRuleTendsToTheExplicitOne) {
    const skeleton::Model model = make_lattice({3, 2, 2});
    const auto set_damping = [](Body& body) { body.set_damping({.alpha = 20, .beta = 1e-4}); };
    Body exact(model);
    set_damping(exact);
    set_off(exact, 500, 50);
    exact.step_explicit(4e-3 / 40000, 40000);
    const auto error = [&](int steps) {
        Body body(model);
        set_damping(body);
        set_off(body, 500, 50);
        for (int i = 0; i < steps; ++i) body.step_implicit(4e-3 / steps);
        return (body.position(11) - exact.position(11)).norm();
    };
    const double coarse = error(400), fine = error(800);
    EXPECT_GT((exact.position(11) - model.spheres[11].center).norm(), 50 * fine);  // of 800 steps: 63 times
    EXPECT_NEAR(coarse / fine, 2, 0.05);  // first order, and a little of the second
}

TEST(LiveMotion, ImplicitStepsOfAnySizeEndInTheEquilibrium) {
    for (const double h : {1e-3, 1.0, 1e6}) {
        skeleton::Model model = make_full_lattice({4, 3, 2});
        give_skin(model);
        Body moved(model), still(model);
        for (Body* body : {&moved, &still}) {
            body->push(body->touch(model.surface.vertices.row(100).transpose()), {0.5, 2, -3});
        }
        still.equilibrium();
        for (int i = 0; i < 400; ++i) moved.step_implicit(h);
        for (int i = 0; i < moved.sphere_count(); ++i) {
            EXPECT_LT((moved.position(i) - still.position(i)).norm(), 1e-8) << h;  // [mm]: 1e-9 of a link of 10 mm
        }
    }
}

TEST(LiveMotion, AWeightOnALinkSwingsAsAPendulum) {
    // A stiff link without flexion or torsion, hung from a held sphere: T = 2 pi sqrt((I + m L^2) / (m g L)) with the
    // bob turning by itself (I does not count).
    skeleton::Model model = make_chain(1, -Vec3::UnitZ(), {1000, 0, 0});
    Body body(model, {.damping_ratio = 0});
    body.set_gravity({0, 0, -9810});
    const double angle = 0.01;
    body.set_pose(1, 10 * Vec3(std::sin(angle), 0, -std::cos(angle)), Eigen::Quaterniond::Identity());
    const double h = 0.05 * body.stable_step(), T = 2 * std::numbers::pi * std::sqrt(10 / 9810.0);
    double time = 0;
    while (body.position(1).x() > 0) {
        body.step_explicit(h);
        time += h;
    }
    EXPECT_NEAR(time, T / 4, 2e-5 * T);  // angle^2 / 64, a step, and the spring's give
}

TEST(LiveMotion, DiesAwayAtTheRatioToldOfTheSoftestMode) {
    // A weight on a soft spring is one mode: after a period its swing is exp(-2 pi zeta / sqrt(1 - zeta^2)) of itself.
    skeleton::Model model = make_chain(1, Vec3::UnitX(), {0.01, 1e4, 1e4});
    const double zeta = 0.1;
    Body body(model, {.damping_ratio = zeta});
    body.set_pose(1, {11, 0, 0}, Eigen::Quaterniond::Identity());
    const double w = std::sqrt(0.01 / model.spheres[1].mass),
                 T = 2 * std::numbers::pi / (w * std::sqrt(1 - zeta * zeta));
    const int steps = 20 * static_cast<int>(std::ceil(T / body.stable_step()));
    body.step_explicit(T / steps, steps);
    EXPECT_NEAR(body.position(1).x() - 10, std::exp(-zeta * w * T),
                1e-7);  // of second order in steps much shorter than T
}

TEST(LiveMotion, DiesAwayAsTheModelSaysUnlessToldOtherwise) {
    skeleton::Model model = make_chain(2);
    model.damping = {.alpha = 3, .beta = 0.25};
    EXPECT_EQ(Body(model).damping().alpha, 3);
    EXPECT_EQ(Body(model).damping().beta, 0.25);
    const Body told(model, {.damping_ratio = 0.2});
    EXPECT_EQ(told.damping().alpha, 0);
    EXPECT_GT(told.damping().beta, 0);
    model.damping.reset();
    EXPECT_NEAR(Body(model).damping().beta, told.damping().beta / 2, 1e-14 * told.damping().beta);  // 0.1
}

TEST(LiveMotion, IsTheSameEachTime) {
    skeleton::Model model = make_full_lattice({4, 3, 2});
    const auto play = [&] {
        Body body(model);
        set_off(body, 500, 50);
        body.step_explicit(1e-6, 500);
        for (int i = 0; i < 20; ++i) body.step_implicit(1e-3);
        return body.position(20);
    };
    EXPECT_EQ(play(), play());
}

TEST(LiveMotionMessages, ASphereWithoutMassCannotMove) {
    skeleton::Model model = make_chain(2);
    model.spheres[2].mass = 0;
    Body body(model);
    EXPECT_EQ(message_of<InvalidInput>([&] { body.step_implicit(1e-3); }),
              "sphere 2 moves and has no mass, or no inertia; motion needs one: give it a 'mass' above 0");
    EXPECT_EQ(message_of<InvalidInput>([&] { Body(make_chain(2)).step_explicit(-1); }),
              "the step is -1 s; it must be above 0");
    EXPECT_EQ(message_of<InvalidInput>([&] {
                  body.set_damping({-1, 0});
              }),
              "damping is -1 1/s and 0 s; both must be at least 0");
    EXPECT_EQ(message_of<InvalidInput>([&] { Body(make_chain(2), {.damping_ratio = -1}); }),
              "damping_ratio is -1; it must be at least 0");
    EXPECT_EQ(message_of<InvalidInput>([&] { Body(make_chain(2), {.contacts = 65}); }),
              "contacts is 65; it must lie in 0 to 64");
}

}  // namespace
}  // namespace palpate::runtime
