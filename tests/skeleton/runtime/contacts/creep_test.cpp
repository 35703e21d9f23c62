// Viscosity: what contacts do creeps, and fades when they are let go.

#include <gtest/gtest.h>

#include <cmath>

#include "mesh/errors.h"
#include "skeleton/runtime/body.h"
#include "tests/skeleton/runtime/live_models.h"

namespace palpate::runtime {
namespace {

constexpr double creep = 0.6, tau = 0.3;  // [-], [s]
const Vec3 tip(20, 10, 14), force(0.02, 0.01, -0.05);

skeleton::Model elastic() {
    skeleton::Model model = skeleton::testing::make_full_lattice({4, 3, 2});
    give_skin(model);
    return model;
}
skeleton::Model creeping() {
    skeleton::Model model = elastic();
    model.effects.push_back({"viscosity", {{"creep", creep, "1"}, {"tau", tau, "s"}}});
    return model;
}

// Where an elastic body comes to rest under so much of the force.
Vec3 elastic_place(double share) {
    Body body(elastic());
    const int contact = body.touch(tip);
    body.push(contact, share * force);
    body.equilibrium();
    return body.place(contact);
}
Vec3 rest_place() { return elastic_place(0); }

// After 10 tau, exp(-10) of a creep of 0.6 is still to come: 3e-5.
void expect_near(const Vec3& found, const Vec3& expected) {
    EXPECT_LT((found - expected).norm(), 4e-5 * (elastic_place(1) - rest_place()).norm())
        << found.transpose() << " for " << expected.transpose();
}

// Heavily damped, steps follow equilibria; the drag's own time is then short beside tau.
void play(Body& body, double seconds, double h) {
    for (int i = 0; i < std::lround(seconds / h); ++i) body.step_implicit(h);
}

TEST(LiveCreep, AHeldForceBendsFurtherAsItsComplianceGrows) {
    Body body(creeping());
    EXPECT_TRUE(body.notices().empty());
    const int contact = body.touch(tip);
    body.push(contact, force);
    body.equilibrium();
    expect_near(body.place(contact), elastic_place(1));  // at once
    double t = 0;
    for (const double seconds : {0.15, 0.3, 1.5}) {
        play(body, seconds, 0.01);
        body.equilibrium();  // what is left of the motion goes, and no time with it
        t += seconds;
        const double grown = 1 + creep * (1 - std::exp(-t / tau));
        expect_near(body.place(contact), elastic_place(grown));
        EXPECT_EQ(body.force(contact), force);
        EXPECT_LT((body.effective_force(contact) - grown * force).norm(),
                  1e-14 * force.norm());  // rounding: steps are exact
    }
}

TEST(LiveCreep, RecoversFromWhatWasLetGo) {
    Body body(creeping());
    const int contact = body.touch(tip), watched = body.touch(tip);
    body.push(contact, force);
    play(body, 0.3, 0.01);
    const double crept = creep * (1 - std::exp(-1));
    body.release(contact);
    body.equilibrium();
    expect_near(body.place(watched), elastic_place(crept));
    play(body, 0.15, 0.01);
    body.equilibrium();
    expect_near(body.place(watched), elastic_place(crept * std::exp(-0.5)));
    play(body, 10, 0.05);
    body.equilibrium();
    expect_near(body.place(watched), rest_place());
}

TEST(LiveCreep, ASpringThatIsHeldRelaxes) {
    Body body(creeping());
    const int contact = body.touch(tip);
    const Vec3 to = rest_place() + Vec3(0, 0, -3);
    body.drag(contact, to, 5000);
    body.equilibrium();
    const double at_once = body.force(contact).norm();
    play(body, 3, 0.01);
    body.equilibrium();
    // A stiff spring holds the place, so that the force falls to 1 / (1 + creep); it gives by some 5 N/mm in 5000.
    EXPECT_NEAR(body.force(contact).norm() / at_once, 1 / (1 + creep), 5e-4);
    // exp(-(1 + creep) t / tau) of the creep is left after 10 tau
    EXPECT_LT((body.effective_force(contact) - (1 + creep) * body.force(contact)).norm(), 5e-7 * at_once);
}

TEST(LiveCreep, ExplicitStepsCreepAlike) {
    Body body(creeping(), {.damping_ratio = 0.5});
    const int contact = body.touch(tip);
    body.push(contact, force);
    body.equilibrium();
    const double h = 0.5 * body.stable_step();
    const int steps = static_cast<int>(0.02 / h);
    body.step_explicit(h, steps);
    EXPECT_LT((body.effective_force(contact) - (1 + creep * (1 - std::exp(-h * steps / tau))) * force).norm(),
              1e-13 * force.norm());  // rounding of each step; steps are exact
}

TEST(LiveCreep, WhatIsBorneAsItIsDoesNotCreep) {
    Body body(creeping());
    const int contact = body.touch(tip);
    body.push_without_creep(contact, force);
    play(body, 1, 0.01);
    body.equilibrium();
    expect_near(body.place(contact), elastic_place(1));
    EXPECT_EQ(body.effective_force(contact), force);
    body.push(contact, force);  // from now on
    play(body, 3, 0.01);
    body.equilibrium();
    expect_near(body.place(contact), elastic_place(1 + creep));
}

TEST(LiveCreep, FreeContactsMakeRoomForNewOnes) {
    Body body(creeping(), {.contacts = 2});
    for (int i = 0; i < 5; ++i) {
        const int contact = body.touch(tip);
        body.push(contact, force);
        play(body, 0.05, 0.01);
        body.release(contact);
    }
    body.touch(tip);
    body.touch(tip);
    EXPECT_THROW(body.touch(tip), InvalidInput);
}

}  // namespace
}  // namespace palpate::runtime
