#include <gmock/gmock.h>

#include "skeleton/effects/effect.h"
#include "tests/pipeline/cli/probe/probed_bar.h"

namespace palpate::pipeline {
namespace {

// What `palpate probe` hides in a set, and what it tells of that.

namespace fs = std::filesystem;
using identify::LoadState;
using identify::MeasurementSet;
using nlohmann::json;
using ::testing::HasSubstr;
using ::testing::Not;

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

}  // namespace
}  // namespace palpate::pipeline
