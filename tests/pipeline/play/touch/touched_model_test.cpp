// The model in the hand: it moves, stiffens and is judged as elsewhere.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "identify/comparison/compare.h"
#include "identify/loading/twin.h"
#include "pipeline/play/touch/running_comparison.h"
#include "pipeline/play/touch/set_text.h"
#include "pipeline/play/touch/touched_model.h"
#include "samples/lattice.h"
#include "skeleton/model/link_modulus.h"
#include "skeleton/statics/equilibrium.h"
#include "skeleton/statics/statics.h"
#include "tests/messages.h"

namespace palpate::pipeline {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

skeleton::Model touched_lattice() { return samples::make_lattice("cube", {3, 3, 2}, 1); }

Vec3 vertex_of(const skeleton::Model& model) {
    Eigen::Index furthest = 0;
    model.surface.vertices.rowwise().norm().maxCoeff(&furthest);
    return model.surface.vertices.row(furthest).transpose();
}

/// Readings of the model itself, at rest and under two loads, with noise.
identify::MeasurementSet measured_on(const skeleton::Model& model) {
    const Vec3 at = vertex_of(model);
    const auto loaded = [&](int probe, const Vec3& force) {
        return identify::LoadState{.probe = probe, .contacts = {{at, force, 0}}};
    };
    identify::MeasurementSet set = identify::simulate_measurements(
        model, {loaded(0, Vec3::Zero()), loaded(1, {0, 0, -0.02}), loaded(2, {0.02, 0.01, 0})},
        identify::markers_on_spheres(model), 0.05, 7);
    return set;
}

/// A tendon from beside the lattice to its far corner.
mesh::Actuator tendon_through(const skeleton::Model& model, bool by_length) {
    const Vec3 to = vertex_of(model).cwiseProduct(Vec3(0.83, 0.71, 0.77));  // no two links are as near
    Points path(3, 3);
    path << to.x(), to.y(), -5, to.x(), to.y(), 0.5 * to.z(), to.x(), to.y(), to.z();
    return {"tendon", mesh::TendonActuator{path, by_length}};
}

TEST(TouchedModel, JudgementIsWhatCompareFinds) {
    const skeleton::Model model = touched_lattice();
    const identify::MeasurementSet set = measured_on(model);
    RunningComparison comparison(model, set);
    double squares = 0, coordinates = 0;
    for (int r = 0; r < comparison.count(); ++r) {
        const RunningComparison::Error error = comparison.evaluate(r);
        squares += error.squares;
        coordinates += error.coordinates;
        EXPECT_TRUE(error.is_full_load);
    }
    EXPECT_NEAR(std::sqrt(squares / coordinates), identify::compare(model, set).rms, 1e-12);
}

TEST(TouchedModel, ASetIsTheSameAsText) {
    const skeleton::Model model = touched_lattice();
    identify::MeasurementSet set = measured_on(model);
    set.gravity = Vec3(0, 0, -9810);
    set.states[1].gravity = Vec3(1, 2, 3);
    set.states[2].pressure = 0.01;
    set.states[2].readings[0].position[1] = identify::missing;
    const nlohmann::json text = set_as_text(set);
    const identify::MeasurementSet again = set_from_text(nlohmann::json::parse(text.dump()));
    EXPECT_EQ(set_as_text(again), text);
    // readings are rounded to 1e-6 mm
    EXPECT_NEAR(identify::compare(model, again).rms, identify::compare(model, set).rms, 1e-6);
}

TEST(TouchedModel, ComplianceIsTheSlopeOfThePlace) {
    const skeleton::Model model = touched_lattice();
    TouchedModel touched(model, Vec3(0, 0, -1000), 0);
    const int touch = touched.touch(vertex_of(model), 0);
    const Vec3 force(0.01, -0.02, 0.03);
    touched.push(touch, force);
    touched.body().equilibrium();
    const std::optional<Mat3> C = touched.compliance(touch);
    ASSERT_TRUE(C);
    for (int c = 0; c < 3; ++c) {
        const Vec3 step = 1e-4 * Vec3::Unit(c);
        touched.push(touch, force + step);
        touched.body().equilibrium();
        const Vec3 up = touched.place(touch);
        touched.push(touch, force - step);
        touched.body().equilibrium();
        const Vec3 slope = (up - touched.place(touch)) / 2e-4;
        // central differences: second order in a step that moves the place by some thousandths of the body
        EXPECT_LT((slope - C->col(c)).norm(), 1e-4 * C->norm());
    }
}

TEST(TouchedModel, ActuatorsDriveItAsTheyDriveTheModel) {
    const skeleton::Model model = touched_lattice();
    for (const bool by_length : {false, true}) {
        const mesh::Actuator tendon = tendon_through(model, by_length);
        TouchedModel touched(model, Vec3::Zero(), 0);
        const int number = touched.add_actuator(tendon);
        const double value = by_length ? 0.1 : 0.01;
        touched.drive(number, value);
        touched.body().equilibrium();
        fem::Effects effects;
        effects.tendons.push_back(
            {.actuator = std::make_shared<const mesh::TendonActuator>(std::get<mesh::TendonActuator>(tendon.kind)),
             .value = value,
             .young = skeleton::link_modulus(model)});
        const skeleton::Equilibrium expected =
            skeleton::StaticsSolver(model, effects).solve(skeleton::stiffness_vector(model), {});
        const Points places = touched.places(model.skin);
        EXPECT_GT((places - model.surface.vertices).cwiseAbs().maxCoeff(), 0.01);  // [mm]
        // the runtime's tests hold equilibria to 1e-8 of what moves, some millimetres
        EXPECT_LT((places - skeleton::observed(model, expected, {}, model.skin)).cwiseAbs().maxCoeff(), 1e-6);
        EXPECT_GT(touched.tension(number), 0);
        if (!by_length) {
            EXPECT_EQ(touched.tension(number), value);
        }
        touched.reset();
        touched.body().equilibrium();
        // what a slack tendon's stiffness leaves: rounding of 30 mm
        EXPECT_LT((touched.places(model.skin) - model.surface.vertices).cwiseAbs().maxCoeff(), 1e-6);
    }
}

TEST(TouchedModel, ATautTendonIsFeltInTheStiffness) {
    const skeleton::Model model = touched_lattice();
    TouchedModel touched(model, Vec3::Zero(), 0);
    const int tendon = touched.add_actuator(tendon_through(model, true));
    touched.drive(tendon, 0.1);
    const int touch = touched.touch(vertex_of(model), 0);
    touched.push(touch, Vec3(0.001, 0, 0.002));
    touched.body().equilibrium();
    const std::optional<Mat3> C = touched.compliance(touch);
    ASSERT_TRUE(C);
    for (int c = 0; c < 3; ++c) {
        const Vec3 step = 1e-4 * Vec3::Unit(c);
        touched.push(touch, Vec3(0.001, 0, 0.002) + step);
        touched.body().equilibrium();
        const Vec3 up = touched.place(touch);
        touched.push(touch, Vec3(0.001, 0, 0.002) - step);
        touched.body().equilibrium();
        // central differences: second order in a step that moves the place by some thousandths of the body
        EXPECT_LT(((up - touched.place(touch)) / 2e-4 - C->col(c)).norm(), 1e-4 * C->norm());
    }
    touched.drive(tendon, 0);
    touched.push(touch, Vec3::Zero());
    touched.body().equilibrium();
    EXPECT_GT((*touched.compliance(touch) - *C).norm(), 1e-3 * C->norm()) << "let out, it is another tangent";
}

TEST(TouchedModel, RefusesActuatorsThatActOnNothing) {
    const skeleton::Model model = touched_lattice();
    TouchedModel touched(model, Vec3::Zero(), 0);
    EXPECT_THAT(message_of([&] {
                    touched.add_actuator({"bellows", mesh::PressureActuator{Vec3(1, 1, 1)}});
                }),
                AllOf(HasSubstr("bellows"), HasSubstr("no cavity")));
    EXPECT_THAT(message_of([&] { touched.drive(0, 1); }), AllOf(HasSubstr("actuator 0"), HasSubstr("there are 0")));
}

TEST(TouchedModel, AnActuatorIsTheSameAsText) {
    const skeleton::Model model = touched_lattice();
    for (const mesh::Actuator& one : {tendon_through(model, true), tendon_through(model, false),
                                      mesh::Actuator{"bellows", mesh::PressureActuator{Vec3(1, 2, 3)}}}) {
        const nlohmann::json text = nlohmann::json::parse(actuator_as_text(one).dump());
        EXPECT_EQ(actuator_as_text(actuator_from_text(text)), text);
        EXPECT_EQ(text["name"], one.name);
    }
    EXPECT_EQ(actuator_as_text(tendon_through(model, true))["kind"], "length");
    const mesh::Actuator by_surface{"bellows", mesh::PressureActuator{mesh::make_sphere({1, 2, 3}, 1, 1)}};
    EXPECT_THAT(message_of([&] { actuator_as_text(by_surface); }), HasSubstr("bellows"));
}

TEST(TouchedModel, TheHandHoldsWhenTheModelChanges) {
    skeleton::Model model = touched_lattice();
    TouchedModel before(model, Vec3::Zero(), 0);
    const int touch = before.touch(vertex_of(model), 0);
    before.push(touch, {0, 0, 0.02});
    before.body().equilibrium();
    model.effects.push_back({"gravity", {{"gx", 0, "mm/s^2"}, {"gy", 0, "mm/s^2"}, {"gz", -9810, "mm/s^2"}}});
    TouchedModel after(model, Vec3::Zero(), 0);
    after.take_over(before);
    EXPECT_LT((after.place(touch) - before.place(touch)).norm(), 1e-12);
    EXPECT_EQ(after.force(touch), before.force(touch));
    after.body().equilibrium();
    EXPECT_LT(after.place(touch).z(), before.place(touch).z());  // it hangs
}

TEST(TouchedModel, ShapeIsTheEquilibriumThatSimulateFinds) {
    const skeleton::Model model = touched_lattice();
    TouchedModel touched(model, Vec3::Zero(), 0);
    const mesh::Contact contact{vertex_of(model), {0.01, 0.02, -0.03}, 0};
    touched.push(touched.touch(contact.point, contact.radius), contact.force);
    touched.body().equilibrium();
    const skeleton::Load load = identify::ContactLoads(model)({contact});
    const Points expected = skeleton::observed(model, skeleton::equilibrium(model, load), load, model.skin);
    // the runtime's tests hold equilibria to 1e-8
    EXPECT_LT((touched.places(model.skin) - expected).cwiseAbs().maxCoeff(), 1e-6);
}

}  // namespace
}  // namespace palpate::pipeline
