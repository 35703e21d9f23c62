// Runs of several specimens together.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "mesh/formats/surface/read_surface.h"
#include "mesh/text/atomic_file.h"
#include "pipeline/body/reference_body.h"
#include "pipeline/case/population_prior.h"
#include "pipeline/command_line/commands.h"
#include "pipeline/output/csv/posterior.h"
#include "pipeline/output/vtk/population_map.h"
#include "skeleton/model/io/model_io.h"
#include "tests/messages.h"
#include "tests/temporary_folder.h"

namespace palpate::pipeline {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::AllOf;
using testing::HasSubstr;

/// A run, and copies of it whose bodies are as many times as stiff in finite elements.
class Pool : public testing::Test {
protected:
    static void SetUpTestSuite() {
        scratch_ = std::make_unique<TemporaryFolder>();
        mesh::write_surface(*scratch_ / "beam.stl", mesh::make_box({0, 0, 0}, {100, 20, 20}, {10, 2, 2}));
        commands::RunOptions options{.input = *scratch_ / "beam.stl", .output = *scratch_ / "run", .overrides = {}};
        options.overrides.set("volume.edge_length", 12);
        options.overrides.set("skeleton.spheres", 8);
        options.overrides.set("probing.probes", 10);
        options.overrides.set("identify.particles", 40);
        options.overrides.set("identify.parameters", "uniform");
        commands::run(options, {});
    }
    static void TearDownTestSuite() { scratch_.reset(); }

    static fs::path specimen(const std::string& name, double young, double sd) {
        const fs::path run = *scratch_ / name;
        fs::remove_all(run);
        fs::copy(*scratch_ / "run", run, fs::copy_options::recursive);
        json compare = json::parse(mesh::read_text(run / "compare/compare.json"));
        compare["baseline"] = {{"young_mpa", young},
                               {"young_sd_mpa", sd},
                               {"poisson", 0.45},
                               {"poisson_sd", 0.0},
                               {"poisson_declared", true}};
        mesh::write_text(run / "compare/compare.json", compare.dump());
        return run;
    }

    static inline std::unique_ptr<TemporaryFolder> scratch_;
};

TEST_F(Pool, TellsTheMeanTheSpreadAndWhoIsUnlikeTheOthers) {
    std::vector<fs::path> runs;
    for (const double young : {0.29, 0.31, 0.3, 0.295, 0.305, 0.302, 0.6})
        runs.push_back(specimen("s" + std::to_string(runs.size()), young, 0.003));
    const fs::path output = *scratch_ / "population";
    const commands::Outcome outcome = commands::pool({runs, output}, {});
    EXPECT_EQ(outcome.code, commands::done);
    EXPECT_EQ(json::parse(mesh::read_text(output / "population.json")), outcome.json);
    const json& young = outcome.json["numbers"][0];
    EXPECT_EQ(young["name"], "young");
    EXPECT_EQ(young["scale"], "logarithmic");
    ASSERT_EQ(young["specimens"].size(), 7u);
    for (const json& one : young["specimens"]) EXPECT_EQ(one["outlying"], one["run"] == "s6") << one;
    EXPECT_NEAR(young["specimens"][0]["own"]["value"].get<double>(), 0.29, 1e-9);
    EXPECT_THAT(outcome.text, AllOf(HasSubstr("Young's modulus [MPa], by finite elements"),
                                    HasSubstr("Unlike the others: s6."), HasSubstr("population.html")));
    // The ratio was told, and nobody found it; the skeleton's stiffness is shared, by its particles.
    const auto names = [&] {
        std::vector<std::string> all;
        for (const json& number : outcome.json["numbers"]) all.push_back(number["name"]);
        return all;
    }();
    EXPECT_THAT(names, AllOf(testing::Contains("flexion"), testing::Not(testing::Contains("poisson"))));
    const std::string page = mesh::read_text(output / "population.html");
    EXPECT_THAT(page, AllOf(HasSubstr("✱ s6"), HasSubstr("next specimen"), testing::Not(HasSubstr("http"))));
    EXPECT_THAT(message_of([&] { commands::pool({runs, *scratch_ / "beam.stl"}, {}); }), HasSubstr("beam.stl"));
}

/// Amplitudes of a map are of the places of one body; over how long a length stiffness varies compares.
TEST_F(Pool, TakesOfAMapWhatSpecimensShare) {
    const auto number = [](double value, double sd, const char* unit) {
        return json{{"value", value}, {"sd", sd}, {"unit", unit}};
    };
    std::vector<fs::path> runs;
    for (const double length : {30.0, 33.0, 31.0}) {
        runs.push_back(specimen("m" + std::to_string(runs.size()), 0.3, 0.003));
        const json map{
            {"effect", "map"},
            {"parameters",
             {{"length", number(length, 1, "mm")}, {"x1", number(4, 1e-6, "mm")}, {"a1", number(0.5, 0.1, "1")}}}};
        fs::create_directories(runs.back() / "diagnose");
        mesh::write_text(runs.back() / "diagnose/diagnosis.json",
                         json{{"explanation", {"map"}}, {"ranking", {map}}}.dump());
    }
    const commands::Outcome outcome = commands::pool({runs, *scratch_ / "maps"}, {});
    std::vector<std::string> of_map;
    for (const json& one : outcome.json["numbers"])
        if (one["name"].get<std::string>().starts_with("map:")) of_map.push_back(one["name"]);
    EXPECT_THAT(of_map, testing::ElementsAre("map:length"));
}

/// Of two inclusions in each specimen nobody says which are alike.
TEST_F(Pool, TakesNoNumbersOfAnEffectThatIsThereTwice) {
    const auto row = [](double x) {
        return json{{"effect", "inclusion"}, {"parameters", {{"cx", {{"value", x}, {"sd", 1}, {"unit", "mm"}}}}}};
    };
    std::vector<fs::path> runs;
    for (const double x : {30.0, 31.0}) {
        runs.push_back(specimen("t" + std::to_string(runs.size()), 0.3, 0.003));
        fs::create_directories(runs.back() / "diagnose");
        mesh::write_text(runs.back() / "diagnose/diagnosis.json",
                         json{{"explanation", {"inclusion", "inclusion"}}, {"ranking", {row(x), row(x + 40)}}}.dump());
    }
    const commands::Outcome outcome = commands::pool({runs, *scratch_ / "twins"}, {});
    for (const json& one : outcome.json["numbers"])
        EXPECT_FALSE(one["name"].get<std::string>().starts_with("inclusion")) << one;
}

TEST_F(Pool, TheNextSpecimenIsExpectedLikeTheOthers) {
    const fs::path population = *scratch_ / "three";
    commands::pool({{specimen("a", 0.27, 0.01), specimen("b", 0.3, 0.01), specimen("c", 0.33, 0.01)}, population}, {});
    const auto priors = read_population_prior(population);
    const identify::InformativePrior* young = identify::prior_of("young", 3, priors);
    const identify::InformativePrior* flexion = identify::prior_of("flexion", 3, priors);
    ASSERT_TRUE(young && flexion);
    EXPECT_NEAR(young->mean, std::log(0.3), 0.03);
    EXPECT_GT(young->sd, 0.1);  // of the logarithms of 0.27, 0.3 and 0.33 in the sample: more for the next one
    EXPECT_LT(young->sd, 0.5);

    // The set says nothing of E, so its body takes all of the prior; the skeleton that of its own stiffness.
    identify::MeasurementSet set = identify::read_measurement_set(*scratch_ / "run/measurements");
    set.material.reset();
    const Reference reference = make_reference(set, 30, {}, priors);
    ASSERT_TRUE(reference.body) << reference.why_none;
    const identify::StiffnessParameter& of_body = reference.body->parameters()[0];
    EXPECT_EQ(of_body.prior_mean, young->mean);
    EXPECT_EQ(of_body.prior_sd, young->sd);

    commands::IdentifyCommandOptions options{.model = *scratch_ / "run/skeleton/model.json",
                                             .set = *scratch_ / "run/measurements",
                                             .output = *scratch_ / "next",
                                             .overrides = {}};
    options.overrides.set("identify.parameters", "uniform");
    options.overrides.set("identify.particles", 40);
    options.overrides.set("identify.prior", population.string());
    const commands::Outcome outcome = commands::identify(options, {});
    EXPECT_THAT(outcome.text, HasSubstr("prior: the population's for"));
    for (const identify::PosteriorRow& row : read_posterior(*scratch_ / "next/posterior.csv")) {
        if (row.parameter != "flexion") continue;
        const double variance = std::log1p(std::pow(row.prior_sd / row.prior_mean, 2));
        EXPECT_NEAR(std::sqrt(variance), flexion->sd, 1e-3 * flexion->sd);
        EXPECT_NEAR(std::log(row.prior_mean) - variance / 2, flexion->mean, 1e-3);
    }
}

TEST_F(Pool, RefusesAPriorThatIsNoPopulation) {
    EXPECT_THAT(message_of([&] { read_population_prior(*scratch_ / "nowhere"); }),
                AllOf(HasSubstr("nowhere/population.json"), HasSubstr("palpate pool")));
    EXPECT_THAT(message_of([&] { read_population_prior(*scratch_ / "run/run.json"); }),
                AllOf(HasSubstr("run.json"), HasSubstr("is no population"), HasSubstr("palpate pool")));
    mesh::write_text(*scratch_ / "bare.json", R"({"format": "palpate-population/1", "numbers": []})");
    EXPECT_THAT(message_of([&] { read_population_prior(*scratch_ / "bare.json"); }), HasSubstr("tells no stiffness"));
    mesh::write_text(*scratch_ / "cut.json", R"({"format": "palpate-population/1", "numbers": [{"name": "young"}]})");
    EXPECT_THAT(message_of([&] { read_population_prior(*scratch_ / "cut.json"); }), HasSubstr("palpate pool"));
}

TEST_F(Pool, AModulusThatIsPoorlyKnownIsPositiveAllTheSame) {
    const commands::Outcome outcome =
        commands::pool({{specimen("a", 0.3, 0.01), specimen("b", 0.3, 0.2), specimen("c", 0.3, 0.01)}, {}}, {});
    const json& young = outcome.json["numbers"][0];
    EXPECT_EQ(young["name"], "young");
    EXPECT_EQ(young["scale"], "logarithmic");
    EXPECT_GT(young["specimens"][1]["own"]["low"], 0);
}

/// A run whose links are identified one by one, of a skeleton with so many spheres.
fs::path run_of_links(const fs::path& scratch, int spheres, double young) {
    const fs::path output = scratch / ("links_" + std::to_string(spheres) + "_" + std::to_string(young));
    commands::RunOptions options{.input = scratch / "beam.stl", .output = output, .overrides = {}};
    options.overrides.set("volume.edge_length", 12);
    options.overrides.set("skeleton.spheres", spheres);
    options.overrides.set("probing.probes", 10);
    options.overrides.set("identify.particles", 40);
    options.overrides.set("material.young", young);
    commands::run(options, {});
    return output;
}

TEST_F(Pool, MapsLinksOverTheMeanBodyWhereSkeletonsCorrespond) {
    const std::vector<fs::path> runs{run_of_links(scratch_->path(), 4, 0.1), run_of_links(scratch_->path(), 4, 0.2)};
    const fs::path output = *scratch_ / "mapped";
    const commands::Outcome outcome = commands::pool({runs, output}, {});
    EXPECT_TRUE(outcome.json["no_map"].is_null());
    EXPECT_THAT(outcome.text, HasSubstr("mean_skeleton.vtp"));
    EXPECT_THAT(mesh::read_text(output / "population.html"), HasSubstr("Map"));

    // In small strain all is in proportion to the modulus: the mean of the logarithms lies in the middle.
    const skeleton::Model first = skeleton::read_model(runs[0] / "identify/model.json");
    const std::vector<LinkMap> maps = maps_of_links(outcome.json, first.links.size());
    const auto flexion = std::ranges::find(maps, "flexion", &LinkMap::kind);
    ASSERT_NE(flexion, maps.end());
    ASSERT_GT(flexion->known(), 0);
    for (std::size_t l = 0; l < first.links.size(); ++l) {
        const double mean = flexion->mean[static_cast<Eigen::Index>(l)];
        if (std::isnan(mean)) continue;
        EXPECT_NEAR(mean / first.links[l].stiffness[1], std::sqrt(2.0), 0.15);
        EXPECT_GT(flexion->spread[static_cast<Eigen::Index>(l)], 0.2);  // ln 2 apart
    }
    const std::string body = mesh::read_text(output / "mean_body.vtp");
    EXPECT_THAT(body, AllOf(HasSubstr("mean flexion [N*mm/rad]"), HasSubstr("spread of ln flexion [-]")));
}

TEST_F(Pool, LeavesOutLinksOfSkeletonsThatDoNotCorrespond) {
    const std::vector<fs::path> runs{run_of_links(scratch_->path(), 4, 0.1), run_of_links(scratch_->path(), 6, 0.1),
                                     specimen("same", 0.3, 0.01), specimen("other", 0.3, 0.01)};
    const commands::Outcome outcome = commands::pool({runs, *scratch_ / "unmapped"}, {});
    EXPECT_THAT(outcome.json["no_map"].get<std::string>(), HasSubstr("spheres"));
    for (const json& number : outcome.json["numbers"])
        EXPECT_THAT(number["name"].get<std::string>(), testing::Not(HasSubstr(":link")));
    EXPECT_THAT(outcome.text, HasSubstr("they do not correspond: links_4_"));
    EXPECT_FALSE(fs::exists(*scratch_ / "unmapped/mean_body.vtp"));
}

TEST_F(Pool, RefusesWhatIsNoPopulation) {
    const fs::path one = specimen("one", 0.3, 0.01);
    EXPECT_THAT(message_of([&] { commands::pool({{one}, {}}, {}); }), HasSubstr("two specimens at least"));
    EXPECT_THAT(message_of([&] {
                    commands::pool({{one, one / "."}, {}}, {});
                }),
                AllOf(HasSubstr("is told twice"), HasSubstr("leave one out")));
    EXPECT_THAT(message_of([&] {
                    commands::pool({{one, *scratch_ / "beam.stl"}, {}}, {});
                }),
                AllOf(HasSubstr("beam.stl"), HasSubstr("no run folder")));
}

}  // namespace
}  // namespace palpate::pipeline
