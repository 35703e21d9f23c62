// `palpate import`: from a rig's files to a set that `palpate check` takes, or one message and nothing written.

#include <gmock/gmock.h>

#include "mesh/text/atomic_file.h"
#include "pipeline/command_line/import_options.h"
#include "tests/identify/recordings/assembly/rig_of_a_bar.h"

namespace palpate::pipeline {
namespace {

using ::testing::AllOf;
using ::testing::ContainsRegex;
using ::testing::HasSubstr;
using ::testing::Not;
namespace fs = std::filesystem;

struct ImportCommand : identify::RigOfABar {
    commands::Outcome run(commands::ImportCommandOptions options, const commands::Common& common = {}) const {
        if (options.files.empty()) options.files = {folder / "points.csv", folder / "load.csv"};
        return commands::import(options, common);
    }
};

TEST_F(ImportCommand, WritesASetAndSaysHowItCameAbout) {
    const commands::Outcome outcome = run({.files = {}, .output = folder / "set"});
    EXPECT_EQ(outcome.code, commands::done);
    EXPECT_THAT(outcome.text, AllOf(HasSubstr("4 states"), HasSubstr("load.csv merged by the lag"), HasSubstr("(1 sd)"),
                                    HasSubstr("Registered by 4 points"), HasSubstr("Next: palpate check")));
    EXPECT_EQ(outcome.json["format"], "palpate-import/1");
    EXPECT_NEAR(outcome.json["clocks"][0]["offset_s"].get<double>(), lag, 0.002);
    EXPECT_LT(outcome.json["registration"]["rms_mm"].get<double>(), noise);
    EXPECT_EQ(nlohmann::json::parse(mesh::read_text(folder / "set/import.json")), outcome.json);
    EXPECT_EQ(commands::check({.input = folder / "set", .overrides = {}}, {}).code, commands::done);
}

TEST_F(ImportCommand, DescribesFilesAndDraftsAMap) {
    const commands::Outcome told = run({.files = {}, .output = {}, .describe = true});
    EXPECT_THAT(told.text,
                AllOf(HasSubstr("points.csv"), HasSubstr("load"), HasSubstr("supports:"), HasSubstr("files:")));
    const commands::Outcome written = run({.files = {}, .output = folder / "draft.yaml", .describe = true});
    EXPECT_THAT(written.text, HasSubstr("--map"));
    EXPECT_EQ(mesh::read_text(folder / "draft.yaml"), told.json["map"].get<std::string>());
    // what is drafted is a map: what is missing is the mesh
    EXPECT_THAT(
        message_of<IoError>([&] { run({.files = {}, .output = folder / "set", .map = folder / "draft.yaml"}); }),
        AllOf(HasSubstr("draft.yaml"), HasSubstr("no file 'body.stl'")));
}

/// The bar's points as in cm, its load as in kN, in a map that is not complete: there is no mesh yet.
TEST_F(ImportCommand, DescribesInTheUnitsOfAMap) {
    std::string text = map();
    text.replace(text.find("mesh: bar.stl"), 13, "mesh: later.stl");
    text.replace(text.find("file: points.csv,"), 17, "file: points.csv, unit: cm,");
    text.replace(text.find("unit: N}"), 8, "unit: kN}");
    const fs::path mapped = folder.write("units.yaml", text);
    const auto described = [&](const fs::path& told, std::vector<fs::path> files = {}) {
        return run({.files = std::move(files), .output = {}, .map = told, .describe = true});
    };
    EXPECT_THAT(described({}).text, AllOf(HasSubstr("in a box of 98.5 x "), ContainsRegex("load +N .* 2[.]0[0-9]+\n")));
    const commands::Outcome outcome = described(mapped);
    EXPECT_THAT(outcome.text, AllOf(HasSubstr("in a box of 985 x "), ContainsRegex("load +N .* 20[0-9][0-9]"),
                                    Not(HasSubstr("supports:"))));
    EXPECT_THAT(outcome.json["map"].get<std::string>(), HasSubstr("file: \"points.csv\"\n    unit: cm\n"));
    EXPECT_EQ(described(mapped, {folder.path()}).text, outcome.text) << "of a folder, the files that the map names";
}

TEST_F(ImportCommand, WritesNothingWhereTheSetWouldNotBeTaken) {
    std::string text = map();
    text.replace(text.find("at: [100, 10, 20]"), 17, "at: [400, 10, 20]");
    folder.write("map.yaml", text);
    EXPECT_THAT(message_of([&] { run({.files = {}, .output = folder / "set"}); }),
                AllOf(HasSubstr("map.yaml"), HasSubstr("would not be taken"), HasSubstr("off the rest surface")));
    EXPECT_FALSE(std::filesystem::exists(folder / "set"));
    for (const auto& entry : std::filesystem::directory_iterator(folder.path()))
        EXPECT_FALSE(entry.is_directory()) << entry.path() << " was left behind";
}

TEST_F(ImportCommand, KeepsWhatItDidNotMake) {
    folder.write("set/notes.txt", "mine");
    EXPECT_THAT(message_of([&] { run({.files = {}, .output = folder / "set"}); }), HasSubstr("--force"));
    EXPECT_EQ(run({.files = {}, .output = folder / "set"}, {.force = true, .seed = {}}).code, commands::done);
}

TEST_F(ImportCommand, SaysWhatIsMissing) {
    EXPECT_THAT(message_of([&] { run({.files = {}, .output = {}}); }),
                AllOf(HasSubstr("-o SET"), HasSubstr("--describe")));
    std::filesystem::remove(folder / "map.yaml");
    EXPECT_THAT(message_of([&] { run({.files = {}, .output = folder / "set"}); }),
                AllOf(HasSubstr("points.csv"), HasSubstr("no map"), HasSubstr("--describe -o map.yaml")));
}

}  // namespace
}  // namespace palpate::pipeline
