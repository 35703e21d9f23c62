// Compare, name the missing effect, add it, watch the error fall: on a small beam whose weight is not specified.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "mesh/text/atomic_file.h"
#include "pipeline/command_line/commands.h"
#include "pipeline/output/html/report.h"
#include "pipeline/run/inputs/model_and_set.h"
#include "skeleton/model/io/model_io.h"
#include "tests/pipeline/heavy_beam.h"

namespace palpate::pipeline {
namespace {

using nlohmann::json;
using ::testing::AllOf;
using ::testing::HasSubstr;

constexpr double edge = 14;  // [mm]: some hundred nodes
constexpr double noise = 0.05;

CaseOverrides coarse() {
    CaseOverrides overrides;
    overrides.set("volume.edge_length", edge);
    overrides.set("skeleton.spheres", 6);
    overrides.set("identify.particles", 40);
    overrides.set("identify.parameters", "uniform");
    return overrides;
}

json read(const std::filesystem::path& file) { return json::parse(mesh::read_text(file)); }

/// One run for all of these tests.
class HeavyBeam : public ::testing::Test {
protected:
    static void SetUpTestSuite() {
        scratch_ = std::make_unique<TemporaryFolder>();
        identify::write_measurement_set(*scratch_ / "set", heavy_beam(true));
        outcome_ = commands::run({.input = *scratch_ / "set", .output = *scratch_ / "run", .overrides = coarse()}, {});
    }
    static void TearDownTestSuite() { scratch_.reset(); }

    static std::filesystem::path path(const std::string& name) { return *scratch_ / name; }

    static inline std::unique_ptr<TemporaryFolder> scratch_;
    static inline commands::Outcome outcome_;
};

TEST_F(HeavyBeam, IsToldThatGravityIsMissing) {
    const json& diagnosis = outcome_.json["diagnosis"];
    EXPECT_EQ(diagnosis["verdict"], "missing-effect");
    EXPECT_EQ(diagnosis["explanation"], json({"gravity"}));
    const json& first = diagnosis["ranking"][0];
    EXPECT_EQ(first["effect"], "gravity");
    const json& gz = first["parameters"]["gz"];
    EXPECT_EQ(gz["unit"], "mm/s^2");
    // The claim is the number with its sd; three of them hold the truth but once in 400 times.
    EXPECT_NEAR(gz["value"].get<double>(), -9810, 3 * gz["sd"].get<double>());
    EXPECT_THAT(outcome_.text, AllOf(HasSubstr("Gravity is missing (probability"), HasSubstr("With gravity:"),
                                     HasSubstr("Next: palpate simulate")));
}

TEST_F(HeavyBeam, ErrsLessOnceGravityIsIn) {
    const json& steps = outcome_.json["ladder"]["steps"];
    ASSERT_EQ(steps.size(), 2U);
    EXPECT_LT(steps[1]["rms_mm"].get<double>(), 0.5 * steps[0]["rms_mm"].get<double>());
    EXPECT_LT(steps[1]["held_out_rms_mm"].get<double>(), 0.5 * steps[0]["held_out_rms_mm"].get<double>());
    EXPECT_LT(steps[1]["reference"]["whitened_rms"].get<double>(), 1.2);
    EXPECT_LT(steps[1]["reference"]["rms_mm"].get<double>(), 3 * noise);
    const skeleton::Model better = skeleton::read_model(path("run/improve/model.json"));
    ASSERT_EQ(better.effects.size(), 1U);
    EXPECT_EQ(better.effects[0].name, "gravity");
}

/// What was found stands first, and of the model that was discarded nothing.
TEST_F(HeavyBeam, LeadsItsDescriptionWithTheVerdict) {
    const std::string text = commands::info({.file = path("run")}, {}).text;
    EXPECT_LT(text.find("Gravity is missing"), text.find("The real-time model with gravity, fitted to all probes,"));
    EXPECT_LT(text.find("With gravity:"), text.find("skeleton  "));
    EXPECT_THAT(text, testing::Not(HasSubstr("The real-time model is off by")));
}

/// A rig's set has no forces that could be played: its model is touched by hand.
TEST(CommandToPlay, DependsOnWhatTheSetPressesWith) {
    identify::MeasurementSet set = heavy_beam(false);
    set.folder = "sets/./beam";
    EXPECT_EQ(commands::command_to_play("run/model.json", set),
              "palpate simulate run/model.json --probes sets/beam/probes.csv -o played");
    for (identify::LoadState& state : set.states) state.contacts.clear();
    EXPECT_EQ(commands::command_to_play("run/model.json", set), "palpate play run/model.json");
}

TEST_F(HeavyBeam, LeavesTheFilesThatItPromises) {
    for (const char* file : {"compare/compare.json", "diagnose/diagnosis.json", "improve/ladder.json",
                             "improve/ladder.pvd", "improve/ladder_001.vtp", "improve/model.json", "improve/model.vtp",
                             "improve/posterior.csv", "report.html", "view.py"}) {
        EXPECT_TRUE(std::filesystem::exists(path("run") / file)) << file;
    }
    const std::string page = mesh::read_text(path("run/report.html"));
    EXPECT_THAT(page, HasSubstr("<b>missing effect</b>verdict: gravity"));
    EXPECT_THAT(page, AllOf(HasSubstr("What is missing"), HasSubstr("Ladder"), HasSubstr("Error budget")));
}

/// Effects may be added by hand after a diagnosis that names others, or none.
TEST_F(HeavyBeam, ItsReportSaysWhatWasAddedUnnamed) {
    const std::string unnamed = ", which this diagnosis does not name.";
    EXPECT_THAT(mesh::read_text(path("run/report.html")), testing::Not(HasSubstr(unnamed)));
    std::filesystem::copy(path("run"), path("unnamed"), std::filesystem::copy_options::recursive);
    json diagnosis = read(path("unnamed/diagnose/diagnosis.json"));
    diagnosis["explanation"] = json::array();
    diagnosis["verdict"] = "unexplained";
    mesh::write_text(path("unnamed/diagnose/diagnosis.json"), diagnosis.dump());
    write_report(path("unnamed"), path("unnamed/report.html"));
    EXPECT_THAT(mesh::read_text(path("unnamed/report.html")), HasSubstr("improved with gravity" + unnamed));
}

TEST_F(HeavyBeam, ComparisonHasTheKeysOfTheContract) {
    const json compare = read(path("run/compare/compare.json"));
    for (const char* key : {"error", "reference", "baseline", "adequate", "p_value", "budget", "load_exponent",
                            "probes", "worst", "markers", "regions"}) {
        EXPECT_TRUE(compare.contains(key)) << key;
    }
    for (const char* key : {"rms_mm", "max_mm", "relative", "whitened_rms"}) {
        EXPECT_TRUE(compare["reference"].contains(key)) << key;
    }
    for (const char* key : {"law", "young_mpa", "poisson", "poisson_sd", "unsure_mm", "discretisation_mm"}) {
        EXPECT_TRUE(compare["baseline"].contains(key)) << key;
    }
    for (const char* key : {"rms_mm", "whitened_rms", "p_value", "strange"}) {
        EXPECT_TRUE(compare["markers"][0].contains(key)) << key;
        EXPECT_TRUE(compare["regions"][0].contains(key)) << key;
    }
    const json& budget = compare["budget"];
    const double sum =
        budget["noise"].get<double>() + budget["reduction"].get<double>() + budget["missing_physics"].get<double>();
    EXPECT_NEAR(sum, 1, 1e-12);  // rounding of three shares
    // A beam of six spheres is coarse by far less than the 4 mm that it sags.
    EXPECT_GT(budget["missing_physics"].get<double>(), 0.8);
}

TEST_F(HeavyBeam, DiagnosisAndLadderHaveTheKeysOfTheContract) {
    const json diagnosis = read(path("run/diagnose/diagnosis.json"));
    for (const char* key : {"verdict", "explanation", "ranking", "next_probe", "notes", "noise_mm", "law", "baseline",
                            "outlier_readings"}) {
        EXPECT_TRUE(diagnosis.contains(key)) << key;
    }
    for (const char* key : {"effect", "kind", "probability", "log_bayes_factor", "predicted_rms_mm", "held_out_rms_mm",
                            "parameters", "confused_with"}) {
        EXPECT_TRUE(diagnosis["ranking"][0].contains(key)) << key;
    }
    const json ladder = read(path("run/improve/ladder.json"));
    EXPECT_EQ(ladder["model"], "model.json");
    for (const char* key : {"verdict", "held_out_probes", "notes"}) EXPECT_TRUE(ladder.contains(key)) << key;
    for (const char* key : {"effects", "rms_mm", "held_out_rms_mm", "relative", "log_evidence", "predicted_rms_mm"}) {
        EXPECT_TRUE(ladder["steps"][0].contains(key)) << key;
    }
    for (const char* key : {"rms_mm", "held_out_rms_mm", "whitened_rms", "held_out_whitened_rms"}) {
        EXPECT_TRUE(ladder["steps"][0]["reference"].contains(key)) << key;
    }
}

TEST_F(HeavyBeam, RepeatsNothingWhenInputsAreUnchanged) {
    const json before = read(path("run/run.json"))["stages"];
    commands::run({.input = path("set"), .output = path("run"), .overrides = coarse()}, {});
    EXPECT_EQ(before, read(path("run/run.json"))["stages"]);
}

/// As after a kill: what went before is read back, and the stage's fits have to start from the same.
TEST_F(HeavyBeam, AStageThatIsDoneAgainAloneEndsTheSame) {
    for (const char* stage : {"improve", "compare", "diagnose"}) {
        const std::filesystem::path again = path(std::string("without-") + stage);
        std::filesystem::copy(path("run"), again, std::filesystem::copy_options::recursive);
        std::filesystem::remove_all(again / stage);
        commands::run({.input = path("set"), .output = again, .overrides = coarse()}, {});
        int files = 0;
        for (const auto& entry : std::filesystem::recursive_directory_iterator(path("run"))) {
            const std::filesystem::path file = std::filesystem::relative(entry.path(), path("run"));
            if (!entry.is_regular_file() || file == "run.json" || file == "report.html") continue;  // they tell times
            EXPECT_EQ(mesh::read_text(entry.path()), mesh::read_text(again / file)) << stage << ": " << file;
            ++files;
        }
        EXPECT_GT(files, 20);
    }
}

/// The model that was improved has gravity in it: a comparison with it finds no more physics missing.
TEST_F(HeavyBeam, TheBetterModelLacksNothing) {
    commands::CompareOptions options{
        .model = path("run/improve/model.json"), .set = path("set"), .output = {}, .tolerance = {}};
    options.overrides.set("volume.edge_length", edge);
    const json compare = commands::compare(options, {}).json;
    EXPECT_LT(compare["reference"]["whitened_rms"].get<double>(), 1.2);
    EXPECT_LT(compare["budget"]["missing_physics"].get<double>(), 0.2);
}

TEST_F(HeavyBeam, ComparesTheSkeletonAloneWhenAskedTo) {
    const json compare = commands::compare({.model = path("run/identify/model.json"),
                                            .set = path("set"),
                                            .output = path("compared"),
                                            .tolerance = {},
                                            .no_reference = true},
                                           {})
                             .json;
    for (const char* key : {"reference", "baseline", "budget"}) EXPECT_TRUE(compare[key].is_null()) << key;
    EXPECT_TRUE(std::filesystem::exists(path("compared/compare.json")));
}

TEST_F(HeavyBeam, IsDiagnosedOnTheSkeletonToo) {
    const json diagnosis = commands::diagnose({.model = path("run/identify/model.json"),
                                               .set = path("set"),
                                               .output = path("diagnosed"),
                                               .without = {"misalignment"},
                                               .body = "skeleton"},
                                              {})
                               .json;
    EXPECT_EQ(diagnosis["ranking"][0]["effect"], "gravity");
    for (const json& c : diagnosis["ranking"]) EXPECT_NE(c["effect"], "misalignment");
    EXPECT_TRUE(diagnosis["baseline"]["poisson"].is_null());
    EXPECT_EQ(read(path("diagnosed/diagnosis.json")), diagnosis);
}

/// An effect named by hand is a step of the ladder, as one that a diagnosis names is.
TEST_F(HeavyBeam, IsImprovedByHand) {
    const json ladder = commands::improve({.model = path("run/skeleton/model.json"),
                                           .set = path("set"),
                                           .output = path("improved"),
                                           .add = {"gravity"},
                                           .overrides = coarse()},
                                          {})
                            .json;
    ASSERT_EQ(ladder["steps"].size(), 2U);
    EXPECT_EQ(ladder["steps"][1]["effects"], json({"gravity"}));
    EXPECT_LT(ladder["steps"][1]["rms_mm"].get<double>(), 0.5 * ladder["steps"][0]["rms_mm"].get<double>());
}

/// A model that lacks nothing is not given anything.
TEST_F(HeavyBeam, ImprovesNothingWhereNothingIsMissing) {
    identify::write_measurement_set(path("light"), heavy_beam(false));
    const json ladder = commands::improve({.model = path("run/skeleton/model.json"),
                                           .set = path("light"),
                                           .output = path("light-improved"),
                                           .automatic = true,
                                           .overrides = coarse()},
                                          {})
                            .json;
    EXPECT_EQ(ladder["steps"].size(), 1U);
    EXPECT_EQ(ladder["verdict"], "adequate");
}

/// What no effect of the catalogue explains becomes part of both models, and a file to go on from.
TEST_F(HeavyBeam, TakesUpWhatIsLeftAndDraftsIt) {
    identify::MeasurementSet set = heavy_beam(false);
    identify::ModelSetting setting{.law = 2, .theta = Eigen::Vector2d(std::log(1.0), std::log(0.1)), .effects = {}};
    setting.effects = skeleton::make_physics({"local-force",
                                              {{"cx", 40, "mm"},
                                               {"cy", 10, "mm"},
                                               {"cz", 10, "mm"},
                                               {"radius", 8, "mm"},
                                               {"fx", 0, "N"},
                                               {"fy", 1.2, "N"},
                                               {"fz", -1.6, "N"}}});
    set.position_noise = noise;
    read_beam(set, setting, Vec3::Zero(), 12);
    identify::write_measurement_set(path("pulled"), set);
    const commands::Outcome outcome = commands::improve({.model = path("run/skeleton/model.json"),
                                                         .set = path("pulled"),
                                                         .output = path("pulled-improved"),
                                                         .residual = true,
                                                         .draft = path("magnet.cpp"),
                                                         .overrides = coarse()},
                                                        {});
    const json& steps = outcome.json["steps"];
    ASSERT_EQ(steps.size(), 2U) << outcome.text;
    EXPECT_EQ(steps[1]["effects"], json({"local-force"}));
    EXPECT_LT(steps[1]["reference"]["held_out_rms_mm"].get<double>(),
              0.5 * steps[0]["reference"]["held_out_rms_mm"].get<double>());
    EXPECT_EQ(outcome.json["draft"], path("magnet.cpp").string());
    EXPECT_THAT(mesh::read_text(path("magnet.cpp")), HasSubstr("return {\"magnet\","));
    EXPECT_THAT(outcome.text, HasSubstr("Draft of an effect: "));
}

/// A sheet with no inside has no finite elements: the comparison goes on without, and says why.
TEST(RunDiagnosis, ABodyThatCannotBeFilledIsComparedWithoutReference) {
    identify::MeasurementSet set = heavy_beam(false);
    set.rest_surface.triangles.conservativeResize(2, 3);
    const Reference reference = make_reference(set, 0);
    EXPECT_EQ(reference.body, nullptr);
    EXPECT_THAT(reference.why_none, HasSubstr("enclose"));
}

}  // namespace
}  // namespace palpate::pipeline
