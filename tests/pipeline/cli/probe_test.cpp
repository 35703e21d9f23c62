// `palpate probe`: what it promises of its loads, what it hides and tells, on a small coarse box.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "identify/measurements/measurement_set.h"
#include "mesh/errors.h"
#include "mesh/formats/surface/read_surface.h"
#include "mesh/text/atomic_file.h"
#include "pipeline/command_line/commands.h"
#include "skeleton/effects/effect.h"
#include "tests/messages.h"
#include "tests/temporary_folder.h"

namespace palpate::pipeline {
namespace {

namespace fs = std::filesystem;
using identify::LoadState;
using identify::MeasurementSet;
using nlohmann::json;
using ::testing::HasSubstr;
using ::testing::Not;

/// A bar of 60 x 20 x 20 mm, held at x = 0, E = 0.1 MPa, and sets that are made of it.
class Probe : public ::testing::Test {
protected:
    void SetUp() override {
        mesh::write_surface(scratch_ / "bar.stl", mesh::make_box({0, 0, 0}, {60, 20, 20}, {6, 2, 2}));
    }

    commands::ProbeCommandOptions options(const BlindSetOptions& synthesis, const std::string& name) const {
        commands::ProbeCommandOptions result{
            .input = scratch_ / "bar.stl", .output = scratch_ / name, .overrides = {}, .synthesis = synthesis};
        result.overrides.set("volume.edge_length", 12);
        result.overrides.set("probing.probes", 8);
        result.overrides.set("probing.markers", 40);
        return result;
    }
    MeasurementSet probe(const BlindSetOptions& synthesis, const std::string& name = "set", int threads = 1) const {
        commands::probe(options(synthesis, name), {.json = false, .force = false, .threads = threads, .seed = {}});
        return identify::read_measurement_set(scratch_ / name);
    }
    MeasurementSet hide(const std::vector<std::string>& effects, const std::string& name = "set") const {
        return probe({.hide = effects}, name);
    }
    std::string text(const std::string& file) const { return mesh::read_text(scratch_ / file); }
    json truth(const std::string& name = "set") const { return json::parse(text(name + "/truth.json")); }
    std::string message(const BlindSetOptions& synthesis) const {
        return message_of<InvalidInput>([&] { commands::probe(options(synthesis, "refused"), {}); });
    }

    const TemporaryFolder scratch_;
};

const LoadState& state_of(const MeasurementSet& set, const LoadState& like) {
    for (const LoadState& state : set.states) {
        if (state.probe == like.probe && state.time == like.time) return state;
    }
    throw std::runtime_error("no such state");
}

/// rms over coordinates of what the readings of two sets differ by [mm].
double rms_difference(const MeasurementSet& a, const MeasurementSet& b) {
    double squares = 0;
    int count = 0;
    for (const LoadState& state : a.states) {
        const LoadState& other = state_of(b, state);
        for (std::size_t r = 0; r < state.readings.size(); ++r) {
            squares += (state.readings[r].position - other.readings[r].position).squaredNorm();
            count += 3;
        }
    }
    return std::sqrt(squares / count);
}

// --- loads ---

TEST_F(Probe, MovesTheBodyAsFarAsAskedInLargeDeformation) {
    const MeasurementSet set = probe({});
    ASSERT_EQ(set.states.size(), 9U);
    EXPECT_TRUE(set.states[0].contacts.empty());
    const double young = 0.1;
    for (const LoadState& state : set.states) {
        if (state.contacts.empty()) continue;
        const double level = ((state.probe - 1) % 3 + 1) / 3.0;
        double largest = 0;
        for (const auto& reading : state.readings) {
            largest = std::max(largest, (reading.position - set.markers[reading.marker].rest).norm());
        }
        const auto& contact = state.contacts.front();
        const double pressure = contact.force.norm() / (std::numbers::pi * contact.radius * contact.radius);
        EXPECT_LE(pressure, 0.3 * young * (1 + 1e-12)) << state.probe;
        // Markers are some of the points that move: none further than asked, and within 2 % of that.
        EXPECT_LE(largest, 1.02 * level * 0.05 * 60) << state.probe;
        // The contacts are at vertices; of these 40 are markers, and one near the contact moves half as far at least.
        if (pressure < 0.299 * young) {
            EXPECT_GE(largest, 0.5 * level * 0.05 * 60) << state.probe;
        }
    }
}

TEST_F(Probe, TellsLawMaterialAndFieldsWhenNothingIsHidden) {
    probe({});
    EXPECT_THAT(text("set/set.yaml"), HasSubstr("young: 0.1"));
    EXPECT_TRUE(fs::exists(scratch_ / "set/field/8_1.vtu"));
    EXPECT_EQ(truth()["law"], "neo-hooke");
    EXPECT_TRUE(truth()["effects"].empty());
    EXPECT_EQ(truth()["noise_mm"], 0);
}

/// By the linear law twice the displacement is twice the force, to rounding.
TEST_F(Probe, InSmallStrainDisplacementIsLinearInTheLoad) {
    auto how = options({.law = fem::MaterialLaw::linear}, "one");
    commands::probe(how, {});
    how.output = scratch_ / "two";
    how.overrides.set("probing.displacement", 0.002);
    commands::probe(how, {});
    const MeasurementSet one = identify::read_measurement_set(scratch_ / "one"),
                         two = identify::read_measurement_set(scratch_ / "two");
    for (std::size_t s = 1; s < one.states.size(); ++s) {
        const double ratio = one.states[s].contacts.front().force.norm() / two.states[s].contacts.front().force.norm();
        EXPECT_NEAR(ratio, 2.5, 1e-9);  // 0.5 % by default against 0.2 %
        for (std::size_t r = 0; r < one.markers.size(); ++r) {
            const Vec3 rest = one.markers[r].rest, u = one.states[s].readings[r].position - rest,
                       v = two.states[s].readings[r].position - rest;
            EXPECT_LT((u - ratio * v).norm(), 1e-9);
        }
    }
}

TEST_F(Probe, ReadsRowsAsPromised) {
    const MeasurementSet set = probe({.levels = 2, .dwell = {0.5, 4}, .unload = true, .continuous = true});
    EXPECT_TRUE(set.continuous);
    ASSERT_EQ(set.states.size(), 1U + 8 * 2 * 3);
    const std::vector<double> times{0.5, 4, 4.5, 5, 8.5, 9};
    for (std::size_t s = 1; s < set.states.size(); ++s) {
        const LoadState& state = set.states[s];
        EXPECT_EQ(state.probe, static_cast<int>((s - 1) / 6 + 1));
        EXPECT_DOUBLE_EQ(state.time, times[(s - 1) % 6]);
        EXPECT_EQ(state.contacts.empty(), (s - 1) % 3 == 2);
    }
    // an elastic body keeps nothing
    for (const auto& r : set.states[3].readings) EXPECT_LT((r.position - set.markers[r.marker].rest).norm(), 1e-6);
}

// --- what is hidden ---

class EachEffect : public Probe, public ::testing::WithParamInterface<const char*> {};

/// What is hidden changes the readings by 5 sigma at least, and nothing else: loads and noise are those of a set that
/// hides nothing. Its numbers, told, give the same set again.
TEST_P(EachEffect, IsSeenAndCanBeToldAgain) {
    const std::string effect = GetParam();
    const MeasurementSet hidden = hide({effect}, "hidden");
    const json truth = this->truth("hidden");
    const double noise = truth["noise_mm"];
    EXPECT_GE(truth["change_rms_mm"].get<double>(), 5 * noise);
    EXPECT_EQ(hidden.position_noise, noise);

    BlindSetOptions again{.hide = truth["hide"], .noise = noise};
    probe(again, "again");
    for (const char* file : {"probes.csv", "markers.csv", "positions.csv", "set.yaml"}) {
        EXPECT_TRUE(text(std::string("hidden/") + file) == text(std::string("again/") + file)) << file;
    }

    BlindSetOptions nothing{.hide = {"none"}, .dwell = {}, .noise = noise};
    if (effect == "viscosity") nothing.dwell = {0.1, 4, 20};
    if (effect == "plasticity") nothing.unload = nothing.continuous = true;
    if (effect == "damage") nothing.back = nothing.continuous = true;
    const MeasurementSet bare = probe(nothing, "bare");
    EXPECT_TRUE(text("bare/probes.csv") == text("hidden/probes.csv"));
    const double change = rms_difference(bare, hidden);
    EXPECT_GE(change, 5 * noise);
    // As the truth tells; outliers as many as were drawn, which is 8 % off that for 330 readings (1 in 3 sigma).
    EXPECT_NEAR(change, truth["change_rms_mm"], (effect == "outliers" ? 0.4 : 1e-3) * change);
}

std::string effect_name(const ::testing::TestParamInfo<const char*>& info) {
    std::string name = info.param;
    std::erase(name, '-');
    return name;
}
INSTANTIATE_TEST_SUITE_P(Probe, EachEffect,
                         ::testing::Values("gravity", "compliant-support", "stiffening", "anisotropy", "inclusion",
                                           "contact", "prestress", "viscosity", "plasticity", "damage", "volume", "map",
                                           "misalignment", "force-gain", "outliers"),
                         effect_name);

/// Pressure acts in a closed shell within the body.
TEST_F(Probe, PressureNeedsACavityAndFindsIt) {
    mesh::Surface hollow = mesh::make_box({0, 0, 0}, {60, 20, 20}, {6, 2, 2});
    mesh::Surface cavity = mesh::make_box({24, 6, 6}, {48, 14, 14}, {3, 1, 1});
    const auto outer = static_cast<int>(hollow.vertices.rows());
    const Eigen::Index triangles = hollow.triangles.rows();
    hollow.vertices.conservativeResize(outer + cavity.vertices.rows(), 3);
    hollow.vertices.bottomRows(cavity.vertices.rows()) = cavity.vertices;
    hollow.triangles.conservativeResize(triangles + cavity.triangles.rows(), 3);
    hollow.triangles.bottomRows(cavity.triangles.rows()) = cavity.triangles.rowwise().reverse().array() + outer;
    mesh::write_surface(scratch_ / "bar.stl", hollow);
    hide({"pressure"});
    EXPECT_GE(truth()["change_rms_mm"].get<double>(), 5 * truth()["noise_mm"].get<double>());
    EXPECT_EQ(truth()["effects"][0]["parameters"]["pressure"]["unit"], "MPa");
}

/// An effect that somebody made known is hidden like any other; the one number that is not told is its strength.
TEST_F(Probe, HidesAnEffectOfAUsersOwn) {
    skeleton::register_effect(
        {"heaviness",
         {{"g", "mm/s^2", skeleton::Range::positive}, {"tilt", "1"}},
         [](const skeleton::EffectNumbers& numbers) {
             return skeleton::make_physics(
                 {"gravity", {{"gx", numbers["tilt"], ""}, {"gy", 0, ""}, {"gz", -numbers["g"], ""}}});
         }});
    hide({"heaviness:tilt=0"});
    EXPECT_GE(truth()["change_rms_mm"].get<double>(), 5 * truth()["noise_mm"].get<double>());
    EXPECT_GT(truth()["effects"][0]["parameters"]["g"]["value"], 0);
    EXPECT_TRUE(says(message({.hide = {"heaviness"}}), {"heaviness", "missing"}));
    EXPECT_TRUE(says(message({.hide = {"heaviness:tilt=0,tall=3"}}), {"tall", "tilt"}));
}

TEST_F(Probe, ToldNumbersAreTaken) {
    hide({"gravity:gz=-500", "inclusion:ratio=5,radius=8"});
    const json effects = truth()["effects"];
    ASSERT_EQ(effects.size(), 2U);
    EXPECT_EQ(effects[0]["parameters"]["gx"], json({{"value", 0.0}, {"unit", "mm/s^2"}}));
    EXPECT_EQ(effects[0]["parameters"]["gz"]["value"], -500);
    EXPECT_EQ(effects[1]["parameters"]["ratio"]["value"], 5);
    EXPECT_EQ(effects[1]["parameters"]["radius"], json({{"value", 8.0}, {"unit", "mm"}}));
    EXPECT_GE(effects[1]["parameters"]["cx"]["value"], 0);
}

TEST_F(Probe, RefusesAMapThatNoSolverResolves) {
    for (const char* contrast : {"map:contrast=11", "map:contrast=0.05"})
        EXPECT_TRUE(says(message({.hide = {contrast}}), {"contrast", "0.1 to 10", "million", "--region"}));
}

TEST_F(Probe, TwoInclusionsLieInTwoPlaces) {
    hide({"inclusion:radius=8", "inclusion:radius=8"});
    const json effects = truth()["effects"];
    ASSERT_EQ(effects.size(), 2U);
    const auto centre = [&](int which) {
        const json& p = effects[which]["parameters"];
        return Vec3(p["cx"]["value"], p["cy"]["value"], p["cz"]["value"]);
    };
    EXPECT_EQ(effects[1]["effect"], "inclusion");
    EXPECT_GT((centre(0) - centre(1)).norm(), 1);
}

TEST_F(Probe, TheSetDoesNotTellWhatItHides) {
    hide({"gravity"});
    const std::string description = text("set/set.yaml");
    for (const char* word : {"young", "poisson", "material", "neo", "gravity"}) {
        EXPECT_THAT(description, Not(HasSubstr(word)));
    }
    EXPECT_THAT(description, HasSubstr("density: 1000"));
    EXPECT_FALSE(fs::exists(scratch_ / "set/field"));
    EXPECT_FALSE(fs::exists(scratch_ / "set/states.csv"));
    probe({.hide = {"none"}, .include_material = true}, "told");
    EXPECT_THAT(text("told/set.yaml"), HasSubstr("young: 0.1"));
}

/// A Poisson's ratio is wrong only against one that somebody told.
TEST_F(Probe, AHiddenVolumeBeliesTheRatioThatTheSetTells) {
    const MeasurementSet set = hide({"volume:poisson=0.3"});
    ASSERT_TRUE(set.material);
    EXPECT_EQ(set.material->poisson, 0.45);
    EXPECT_TRUE(std::isnan(set.material->young));
}

/// A gain is of what the sensor says: readings are those of another force, the reported one is not.
TEST_F(Probe, AGainMakesEverySecondProbeAnother) {
    const MeasurementSet bare = probe({.hide = {"none"}, .noise = 0}, "bare"),
                         gained = probe({.hide = {"force-gain:gain=1.2"}, .noise = 0}, "gained");
    for (std::size_t s = 0; s < bare.states.size(); ++s) {
        const MeasurementSet one = [&] {
            MeasurementSet part = bare;
            part.states = {bare.states[s]};
            return part;
        }();
        const bool is_second = bare.states[s].probe > 0 && bare.states[s].probe % 2 == 0;
        EXPECT_EQ(rms_difference(one, gained) > 1e-3, is_second) << bare.states[s].probe;
    }
}

TEST_F(Probe, ReadingsCanBeMissingAndUnlabelled) {
    const MeasurementSet set = probe({.missing = 0.2, .unlabelled = 0.3});
    std::size_t readings = 0;
    int unlabelled = 0;
    for (const LoadState& state : set.states) {
        readings += state.readings.size();
        for (const auto& r : state.readings) unlabelled += r.marker < 0;
    }
    // 360 readings: 4 sigma of their number, and of those without a label
    EXPECT_NEAR(static_cast<double>(readings), 0.8 * 360, 4 * std::sqrt(0.16 * 360));
    EXPECT_NEAR(unlabelled, 0.3 * static_cast<double>(readings), 4 * std::sqrt(0.21 * 288));
}

TEST_F(Probe, ThreadsAndRepetitionChangeNoNumber) {
    const BlindSetOptions synthesis{.hide = {"gravity", "inclusion"}};
    probe(synthesis, "one", 1);
    probe(synthesis, "three", 3);
    for (const char* file : {"probes.csv", "positions.csv", "truth.json", "set.yaml"}) {
        EXPECT_TRUE(text(std::string("one/") + file) == text(std::string("three/") + file)) << file;
    }
}

TEST_F(Probe, ASeedMovesProbesAndEffects) {
    auto how = options({.hide = {"gravity"}}, "other");
    how.overrides.set("seed", 7);
    commands::probe(how, {});
    hide({"gravity"});
    EXPECT_NE(text("set/probes.csv"), text("other/probes.csv"));
    EXPECT_NE(truth()["effects"], truth("other")["effects"]);
}

TEST_F(Probe, LeavesASetThatCheckAccepts) {
    probe({.hide = {"gravity", "outliers"}, .dwell = {1, 3}, .unload = true, .missing = 0.1, .unlabelled = 0.1});
    const commands::Outcome outcome = commands::check({.input = scratch_ / "set", .overrides = {}}, {});
    EXPECT_EQ(outcome.code, commands::done);
    EXPECT_TRUE(outcome.json["faults"].empty());
}

// --- what cannot be ---

TEST_F(Probe, RefusesWhatCannotBeOnThisBody) {
    EXPECT_TRUE(says(message({.hide = {"pressure"}}), {"pressure", "cavities"}));
    EXPECT_TRUE(says(message({.hide = {"torsion"}}), {"torsion", "links", "model.json"}));
    EXPECT_TRUE(says(message({.hide = {"stiffening"}, .law = fem::MaterialLaw::linear}), {"stiffening", "--linear"}));
    EXPECT_TRUE(says(message({.hide = {"outliers"}, .noise = 0}), {"outliers", "--noise"}));
    EXPECT_TRUE(says(message({.hide = {"compliant-support:stiffness=-1"}}), {"stiffness", "-1", "above 0"}));
    EXPECT_TRUE(says(message({.hide = {"force-gain:gain=0"}}), {"force-gain", "gain", "0"}));
    EXPECT_TRUE(says(message({.hide = {"contact:nx=0"}}), {"contact", "direction"}));
    EXPECT_FALSE(fs::exists(scratch_ / "refused")) << "something was half-written";
}

/// A body that does not bear what is hidden in it makes no set.
TEST_F(Probe, TellsThatTheBodyDoesNotBearWhatIsHidden) {
    const std::string message = message_of<SolverFailure>(
        [&] { commands::probe(options({.hide = {"prestress:sxx=-5,syy=-5"}}, "refused"), {}); });
    EXPECT_TRUE(says(message, {"prestress", "equilibrium"}));
    EXPECT_FALSE(fs::exists(scratch_ / "refused"));
}

TEST_F(Probe, RefusesLinearElements) {
    auto how = options({}, "refused");
    how.overrides.set("volume.linear_elements", "true");
    EXPECT_TRUE(says(message_of<InvalidInput>([&] { commands::probe(how, {}); }), {"--linear-elements"}));
}

// --- the skeleton as the truth ---

TEST_F(Probe, ASkeletonCanBeTheTruth) {
    commands::SkeletonOptions make{.input = scratch_ / "bar.stl", .output = scratch_ / "model.json", .overrides = {}};
    make.overrides.set("skeleton.spheres", 6);
    make.overrides.set("volume.edge_length", 12);
    commands::skeleton(make, {});
    const auto twin = [&](const BlindSetOptions& synthesis, const std::string& name) {
        auto how = options(synthesis, name);
        how.input = scratch_ / "model.json";
        commands::probe(how, {});
        return identify::read_measurement_set(scratch_ / name);
    };
    for (const char* effect : {"gravity", "torsion", "anisotropy"}) {
        const MeasurementSet hidden = twin({.hide = {effect}}, "hidden");  // on its skin
        const json truth = this->truth("hidden");
        EXPECT_EQ(truth["body"], "skeleton");
        EXPECT_TRUE(truth["material"].is_null());
        const double noise = truth["noise_mm"];
        const MeasurementSet bare = twin({.hide = {"none"}, .noise = noise}, "bare");
        EXPECT_GE(rms_difference(bare, hidden), 5 * noise) << effect;
        EXPECT_EQ(commands::check({.input = scratch_ / "hidden", .overrides = {}}, {}).code, commands::done);
    }
    EXPECT_TRUE(says(message_of<InvalidInput>([&] { twin({.hide = {"volume"}}, "refused"); }), {"volume", "links"}));
    EXPECT_TRUE(says(message_of<InvalidInput>([&] { twin({.law = fem::MaterialLaw::svk}, "refused"); }), {"--law"}));
    EXPECT_TRUE(
        says(message_of<InvalidInput>([&] { twin({.hide = {"contact"}, .law = fem::MaterialLaw::linear}, "refused"); }),
             {"contact", "--linear"}));
}

}  // namespace
}  // namespace palpate::pipeline
