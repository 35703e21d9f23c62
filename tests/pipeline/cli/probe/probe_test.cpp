#include <gmock/gmock.h>

#include <numbers>

#include "tests/pipeline/cli/probe/probed_bar.h"

// `palpate probe`: what it promises of its loads and of the set that it leaves, on a small coarse box.

namespace palpate::pipeline {
namespace {

namespace fs = std::filesystem;
using identify::LoadState;
using identify::MeasurementSet;
using nlohmann::json;
using ::testing::HasSubstr;

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

TEST_F(Probe, RefusesLinearElements) {
    auto how = options({}, "refused");
    how.overrides.set("volume.linear_elements", "true");
    EXPECT_TRUE(says(message_of<InvalidInput>([&] { commands::probe(how, {}); }), {"--linear-elements"}));
}

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
