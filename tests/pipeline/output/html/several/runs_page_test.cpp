#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <nlohmann/json.hpp>

#include "mesh/text/atomic_file.h"
#include "pipeline/case/json_file.h"
#include "pipeline/command_line/commands.h"
#include "pipeline/output/text/comparison/runs.h"
#include "pipeline/run/several/runs.h"
#include "tests/messages.h"
#include "tests/pipeline/output/html/beam_run.h"
#include "tests/temporary_folder.h"

namespace palpate::pipeline {
namespace {

using nlohmann::json;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

TEST(RunsSideBySide, TellWhatDiffersAndWhichIsBest) {
    const TemporaryFolder scratch;
    commands::RunOptions finer = beam_options(scratch.path(), scratch / "finer");
    finer.overrides.set("skeleton.spheres", 9);
    commands::run(finer, {});
    const commands::Outcome outcome =
        commands::report({.runs = {beam_run(), scratch / "finer"}, .output = scratch / "runs.html"}, {});

    const json& told = outcome.json;
    EXPECT_TRUE(told["same_states"].get<bool>());
    EXPECT_TRUE(told["same_readings"].get<bool>());
    std::map<std::string, std::vector<std::string>> settings;
    for (const json& one : told["settings"]) settings[one["setting"]] = one["values"];
    EXPECT_EQ(settings.at("skeleton.spheres"), (std::vector<std::string>{"6", "9"}));
    EXPECT_FALSE(settings.contains("probing.probes"));
    const json first = json_of_file(beam_run() / "compare/compare.json"),
               second = json_of_file(scratch / "finer/compare/compare.json");
    ASSERT_EQ(told["states"].size(), first["probes"].size());
    for (std::size_t s = 0; s < told["states"].size(); ++s)
        EXPECT_EQ(told["states"][s]["rms_mm"], (json{first["probes"][s]["rms_mm"], second["probes"][s]["rms_mm"]}));

    const bool finer_is_better = second["error"]["rms_mm"] < first["error"]["rms_mm"];
    const std::string best = finer_is_better ? "finer has the least error" : "run has the least error";
    EXPECT_THAT(outcome.text, AllOf(HasSubstr(best), HasSubstr("skeleton.spheres")));
    const std::string page = mesh::read_text(scratch / "runs.html");
    EXPECT_THAT(page, AllOf(HasSubstr(best), HasSubstr("skeleton.spheres"), HasSubstr("probe 1, time"),
                            Not(HasSubstr("http"))));
}

TEST(RunsSideBySide, OfOtherStatesAreNotRanked) {
    NamedRun one{"one", read_run(beam_run())}, other{"other", one.files};
    json& load = other.files.compare["probes"].back()["load"]["value"];
    load = 0.5 * load.get<double>();
    other.files.compare["error"]["rms_mm"] = 0.0;
    const json told = runs_json({one, other});
    EXPECT_FALSE(told["same_states"].get<bool>());
    EXPECT_TRUE(told["states"].empty());
    EXPECT_THAT(runs_table(told), HasSubstr("not ranked"));
}

/// The same loads, and other readings: less of them to explain is no better model.
TEST(RunsSideBySide, OfOtherReadingsAreNotRanked) {
    NamedRun one{"one", read_run(beam_run())}, other{"other", one.files};
    for (json& state : other.files.compare["probes"]) state["rms_mm"] = 0.5 * state["rms_mm"].get<double>();
    other.files.compare["error"]["rms_mm"] = 0.5 * other.files.compare["error"]["rms_mm"].get<double>();
    const json told = runs_json({one, other});
    EXPECT_TRUE(told["same_states"].get<bool>());
    EXPECT_FALSE(told["same_readings"].get<bool>());
    EXPECT_THAT(runs_table(told), AllOf(HasSubstr("different measurements"), HasSubstr("not ranked")));
}

/// Where forces alone are read, errors are in newtons.
TEST(RunsSideBySide, OfForcesAreRankedInNewtons) {
    NamedRun one{"one", read_run(beam_run())};
    one.files.compare["probes"] = json::array();
    one.files.compare["error"]["rms_mm"] = 0.0;
    one.files.compare["error"]["reactions"] = {{"rms_n", 0.02}, {"max_n", 0.05}, {"relative", 0.1}};
    NamedRun other{"other", one.files};
    other.files.compare["error"]["reactions"] = {{"rms_n", 0.01}, {"max_n", 0.03}, {"relative", 0.05}};
    EXPECT_THAT(best_run_in_words(runs_json({one, other})), AllOf(HasSubstr("other has"), HasSubstr("0.01 N rms")));
    other.files.compare["error"]["reactions"]["relative"] = 0.1;
    EXPECT_THAT(best_run_in_words(runs_json({one, other})), HasSubstr("different measurements"));
}

/// Runs with ladders: only errors on the same held-out probes can be ranked.
TEST(RunsSideBySide, AreRankedByWhatWasHeldOutOfAll) {
    NamedRun fitted{"fitted", read_run(beam_run())}, foretold{"foretold", fitted.files};
    const double error = fitted.files.compare["error"]["rms_mm"];
    foretold.files.compare["error"]["rms_mm"] = 2 * error;
    const auto ladder = [](double held_out, int probe) {
        return json{{"steps", {{{"effects", json::array()}, {"held_out_rms_mm", held_out}}}},
                    {"held_out_probes", {probe}}};
    };
    fitted.files.ladder = ladder(0.3, 1);
    foretold.files.ladder = ladder(0.2, 1);
    EXPECT_THAT(best_run_in_words(runs_json({fitted, foretold})),
                HasSubstr("foretold has the least error on held-out probes, 0.2 mm"));
    foretold.files.ladder = ladder(0.3002, 1);
    EXPECT_THAT(best_run_in_words(runs_json({fitted, foretold})),
                HasSubstr("No run has a smaller error on held-out probes"));
    foretold.files.ladder = ladder(0.2, 2);
    EXPECT_THAT(best_run_in_words(runs_json({fitted, foretold})),
                HasSubstr("fitted has the least error on the probes it was fitted to"));
}

TEST(RunsSideBySide, NeedAPlaceForTheirPage) {
    EXPECT_THAT(message_of([] {
                    commands::report({.runs = {beam_run(), beam_run()}, .output = {}}, {});
                }),
                AllOf(HasSubstr("2 runs"), HasSubstr("-o")));
}

}  // namespace
}  // namespace palpate::pipeline
