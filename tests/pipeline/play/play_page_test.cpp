// The model in the hand: what a page is made of and what its numbers are. The page itself is used in play_test.py.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "identify/comparison/compare.h"
#include "identify/loading/twin.h"
#include "mesh/errors.h"
#include "mesh/text/atomic_file.h"
#include "pipeline/command_line/commands.h"
#include "pipeline/play/play_data.h"
#include "pipeline/play/play_page.h"
#include "pipeline/play/touch/running_comparison.h"
#include "pipeline/play/touch/set_text.h"
#include "pipeline/play/touch/touched_model.h"
#include "samples/lattice.h"
#include "skeleton/model/io/model_io.h"
#include "skeleton/statics/equilibrium.h"
#include "skeleton/statics/statics.h"
#include "tests/messages.h"
#include "tests/temporary_folder.h"

namespace palpate::pipeline {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

skeleton::Model lattice_in_the_hand() { return samples::make_lattice("cube", {3, 3, 2}, 1); }

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

TEST(InTheHand, JudgementIsWhatCompareFinds) {
    const skeleton::Model model = lattice_in_the_hand();
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

TEST(InTheHand, ASetIsTheSameAsText) {
    const skeleton::Model model = lattice_in_the_hand();
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

TEST(InTheHand, ComplianceIsTheSlopeOfThePlace) {
    const skeleton::Model model = lattice_in_the_hand();
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

TEST(InTheHand, TheHandHoldsWhenTheModelChanges) {
    skeleton::Model model = lattice_in_the_hand();
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

TEST(InTheHand, ShapeIsTheEquilibriumThatSimulateFinds) {
    const skeleton::Model model = lattice_in_the_hand();
    TouchedModel touched(model, Vec3::Zero(), 0);
    const mesh::Contact contact{vertex_of(model), {0.01, 0.02, -0.03}, 0};
    touched.push(touched.touch(contact.point, contact.radius), contact.force);
    touched.body().equilibrium();
    const skeleton::Load load = identify::ContactLoads(model)({contact});
    const Points expected = skeleton::observed(model, skeleton::equilibrium(model, load), load, model.skin);
    // the runtime's tests hold equilibria to 1e-8
    EXPECT_LT((touched.places(model.skin) - expected).cwiseAbs().maxCoeff(), 1e-6);
}

/// Beside what finite elements tell of it, where the model has another number.
TEST(InTheHand, SaysHowWellAnEffectIsKnown) {
    const TemporaryFolder scratch;
    skeleton::Model model = lattice_in_the_hand();
    model.effects = {{"gravity", {{"gx", 0, "mm/s^2"}, {"gy", 12, "mm/s^2"}, {"gz", -9790, "mm/s^2"}}},
                     {"compliant-support", {{"stiffness", 2, "N/mm"}, {"turning", 1, "1"}}}};
    std::filesystem::create_directories(scratch / "run/identify");
    std::filesystem::create_directories(scratch / "run/diagnose");
    skeleton::write_model(scratch / "run/identify/model.json", model);
    mesh::write_text(scratch / "run/run.json", "{}");
    const auto numbers = [&] {
        const nlohmann::json effects =
            nlohmann::json::parse(play_data(scratch / "run", {}).content.dump())["models"][0]["effects"];
        return std::pair(effects[0]["numbers"], effects[1]["numbers"]);
    };
    EXPECT_EQ(numbers().first[2], "gz = -9790 mm/s^2") << "nothing was diagnosed";
    const nlohmann::json diagnosis = {{"explanation", {"gravity"}},
                                      {"ranking",
                                       {{{"effect", "gravity"},
                                         {"parameters",
                                          {{"gx", {{"value", 0.0}, {"sd", nullptr}}},
                                           {"gy", {{"value", 40.0}, {"sd", 30.0}}},
                                           {"gz", {{"value", -9790.0}, {"sd", 20.0}}}}}}}}};
    mesh::write_text(scratch / "run/diagnose/diagnosis.json", diagnosis.dump());
    EXPECT_EQ(numbers().first, nlohmann::json({"gx = 0 mm/s^2", "gy = 12 mm/s^2 (40 ± 30 in finite elements)",
                                               "gz = -9790 ± 20 mm/s^2"}));
    EXPECT_EQ(numbers().second[0], "stiffness = 2 N/mm") << "of this one nothing was";
}

/// Of the hundred and more numbers of a map its sentence tells what matters.
TEST(InTheHand, SumsUpAMap) {
    const TemporaryFolder scratch;
    skeleton::Model model = lattice_in_the_hand();
    skeleton::EffectRecord map{"map", {{"length", 5, "mm"}}};
    for (int i = 1; i <= 4; ++i) {
        for (const char* axis : {"x", "y", "z"})
            map.parameters.push_back({axis + std::to_string(i), *axis == 'x' ? 20.0 * i : 0.0, "mm"});
        map.parameters.push_back({"a" + std::to_string(i), i == 2 ? 1.2 : 0.0, "1"});
    }
    model.effects = {map};
    skeleton::write_model(scratch / "model.json", model);
    const nlohmann::json content = nlohmann::json::parse(play_data(scratch / "model.json", {}).content.dump());
    const nlohmann::json numbers = content["models"][0]["effects"][0]["numbers"];
    ASSERT_EQ(numbers.size(), 1U);
    EXPECT_THAT(numbers[0].get<std::string>(), HasSubstr("times its mean round (40, 0, 0) mm"));
}

TEST(InTheHand, WritesOnePageThatNeedsNoNetwork) {
    const TemporaryFolder scratch;
    skeleton::write_model(scratch / "model.json", lattice_in_the_hand());
    const commands::Outcome outcome =
        commands::play({.input = scratch / "model.json", .output = scratch / "page.html"}, {});
    EXPECT_EQ(outcome.code, commands::done);
    const std::string page = mesh::read_text(scratch / "page.html");
    EXPECT_EQ(outcome.json["bytes"].get<std::size_t>(), page.size());
    EXPECT_LT(page.size(), 5'000'000U);
    EXPECT_THAT(page, Not(AnyOf(HasSubstr("src=\"http"), HasSubstr("href=\"http"), HasSubstr("@import"))));
    EXPECT_THAT(page,
                AllOf(HasSubstr("<meta name=\"generator\" content=\"palpate\">"), HasSubstr("id=\"play-module\"")));
    // palpate's own page may be replaced, another one not
    EXPECT_NO_THROW(commands::play({.input = scratch / "model.json", .output = scratch / "page.html"}, {}));
    const auto other = scratch.write("other.html", "<html>mine</html>");
    EXPECT_THAT(message_of([&] { commands::play({.input = scratch / "model.json", .output = other}, {}); }),
                AllOf(HasSubstr("other.html"), HasSubstr("--force")));
}

TEST(InTheHand, SaysWhatCannotBePlayed) {
    const TemporaryFolder scratch;
    const auto message = [&](const std::filesystem::path& model) {
        return message_of([&] { commands::play({.input = model, .output = scratch / "page.html"}, {}); });
    };
    EXPECT_THAT(message_of<IoError>([&] { commands::play({.input = scratch / "none.json", .output = {}}, {}); }),
                AllOf(HasSubstr("none.json"), HasSubstr("does not exist")));
    std::filesystem::create_directory(scratch / "empty");
    EXPECT_THAT(message(scratch / "empty"), AllOf(HasSubstr("empty"), HasSubstr("no model.json")));
    mesh::write_text(scratch / "liver.stl", "solid\nendsolid\n");
    EXPECT_THAT(message(scratch / "liver.stl"), AllOf(HasSubstr("liver.stl"), HasSubstr("--pick")));
    skeleton::Model bare = lattice_in_the_hand();
    bare.surface = {};
    bare.skin.clear();
    skeleton::write_model(scratch / "bare.json", bare);
    EXPECT_THAT(message(scratch / "bare.json"), AllOf(HasSubstr("bare.json"), HasSubstr("skin")));
    skeleton::write_model(scratch / "model.json", lattice_in_the_hand());
    EXPECT_THAT(message_of([&] { commands::play({.input = scratch / "model.json", .output = scratch / "empty"}, {}); }),
                AllOf(HasSubstr("empty"), HasSubstr("page.html")));
    EXPECT_FALSE(std::filesystem::exists(scratch / "page.html"));
}

}  // namespace
}  // namespace palpate::pipeline
