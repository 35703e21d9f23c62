// The program as a shell sees it: exit codes, and what stands on which stream.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <array>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>

#include "mesh/formats/surface/read_surface.h"
#include "pipeline/case/settings/settings.h"
#include "pipeline/command_line/terminal/console.h"
#include "tests/places.h"
#include "tests/temporary_folder.h"

namespace palpate::pipeline {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

struct Finished {
    int code;
    std::string out;
};

Finished palpate(const std::string& arguments) {
    const std::string command = std::string(program_file) + " " + arguments + " 2>/dev/null";
    FILE* pipe = popen(command.c_str(), "r");
    std::string out;
    std::array<char, 4096> buffer{};
    while (const std::size_t count = fread(buffer.data(), 1, buffer.size(), pipe)) out.append(buffer.data(), count);
    return {WEXITSTATUS(pclose(pipe)), out};
}

TEST(CommandLine, ExitCodesTellWhatWentWrong) {
    const TemporaryFolder scratch;
    EXPECT_EQ(palpate("--version").code, 0);
    EXPECT_EQ(palpate("--help").code, 0);
    EXPECT_EQ(palpate("").code, 2);
    EXPECT_EQ(palpate("rnu x").code, 2);
    EXPECT_EQ(palpate("run --spheres many x.stl").code, 2);
    EXPECT_EQ(palpate("improve model.json set").code, 2);  // what is to be added?
    EXPECT_EQ(palpate("improve model.json set --auto --add gravity").code, 2);
    EXPECT_EQ(palpate("diagnose model.json set --body spheres").code, 2);
    EXPECT_EQ(palpate("effects gravty").code, 3);
    EXPECT_EQ(palpate("check " + (scratch / "none.stl").string()).code, 3);
}

/// Those that exclude each other, too.
TEST(CommandLine, CompletesAllFlagsOfACommand) {
    const std::string script = palpate("completion bash").out;
    EXPECT_THAT(script, AllOf(HasSubstr("--auto"), HasSubstr("--add"), HasSubstr("--particles")));
}

TEST(CommandLine, VersionTellsWhatIsLinkedAndUnderWhichLicence) {
    const std::string text = palpate("--version").out;
    EXPECT_THAT(text, StartsWith("palpate "));
    EXPECT_THAT(text, HasSubstr("TetGen"));
    const auto told = nlohmann::json::parse(palpate("--version --json").out);
    EXPECT_EQ(text.substr(0, text.find('\n')), "palpate " + told["version"].get<std::string>());
    EXPECT_EQ(told["licence_of_the_program"], "GPL-3.0-or-later AND AGPL-3.0-or-later");
    for (const auto& library : told["libraries"]) {
        const std::string number = library["version"];
        EXPECT_EQ(number.find_first_not_of("0123456789."), std::string::npos) << library;
        EXPECT_NE(number.find('.'), std::string::npos) << library;
    }
}

TEST(CommandLine, JsonStandsAloneOnStandardOutput) {
    const TemporaryFolder scratch;
    mesh::write_surface(scratch / "box.stl", mesh::make_box({0, 0, 0}, {10, 2, 2}, {5, 1, 1}));
    const Finished check = palpate("check --json " + (scratch / "box.stl").string());
    EXPECT_EQ(check.code, 0);
    const auto result = nlohmann::json::parse(check.out);
    EXPECT_TRUE(result["surface"]["sound"].get<bool>());
    EXPECT_NEAR(result["surface"]["volume_mm3"].get<double>(), 40.0, 1e-4);  // STL holds single precision

    EXPECT_TRUE(nlohmann::json::parse(palpate("effects --json").out)["effects"].is_array());
    EXPECT_EQ(nlohmann::json::parse(palpate("effects gravity --json").out)["kind"], "body");

    const Finished failed = palpate("check --json " + (scratch / "none.stl").string());
    EXPECT_EQ(failed.code, 3);
    EXPECT_TRUE(nlohmann::json::parse(failed.out).contains("error"));
}

/// What stands on standard error.
std::string complaint(const std::string& arguments) {
    const std::string command = std::string(program_file) + " " + arguments + " 2>&1 >/dev/null";
    FILE* pipe = popen(command.c_str(), "r");
    std::string out;
    std::array<char, 4096> buffer{};
    while (const std::size_t count = fread(buffer.data(), 1, buffer.size(), pipe)) out.append(buffer.data(), count);
    pclose(pipe);
    return out;
}

TEST(CommandLine, WrongUsageIsToldLikeAnyOtherError) {
    EXPECT_THAT(complaint("rnu x"), StartsWith("error: 'rnu' is not a command (did you mean 'run'?)"));
    EXPECT_THAT(complaint("--threads 2 chek mesh"), HasSubstr("did you mean 'check'?"));
    EXPECT_THAT(complaint(""), StartsWith("error: a command is needed, one of run, check"));
    EXPECT_THAT(complaint("run"), StartsWith("error: palpate run: INPUT is needed; 'palpate run --help'"));
    EXPECT_THAT(complaint("check a b"), StartsWith("error: palpate check: unexpected argument 'b'"));
    EXPECT_THAT(complaint("check a --threads 0"), HasSubstr("--threads: '0' is not a number from 1 to 1024"));
    EXPECT_THAT(complaint("compare a b --tolerance -1"), HasSubstr("--tolerance: '-1' is not a number of 0 or more"));
    EXPECT_THAT(complaint("improve a b"), HasSubstr("one of --add, --auto or --residual is needed"));
    EXPECT_THAT(complaint("diagnose a b --body spheres"),
                HasSubstr("'spheres' is not supported; use reference or skeleton"));
    EXPECT_THAT(complaint("check a --threads"), HasSubstr("--threads needs a number from 1 to 1024"));
    EXPECT_THAT(complaint("probe a --depth 0"), HasSubstr("--depth: '0' is not a number above 0"));
    EXPECT_THAT(complaint("completion fish"), HasSubstr("'fish' is not supported; use bash or zsh"));
    EXPECT_THAT(complaint("improve a b --auto --residual"), HasSubstr("give only one of --add, --auto and --residual"));
    EXPECT_THAT(complaint("run a --young 1 --young 2"), HasSubstr("--young is given more than once"));
    EXPECT_THAT(complaint("compare a b --tol 1"), HasSubstr("no flag '--tol' (did you mean '--tolerance'?)"));
    EXPECT_THAT(complaint("check a --jsn"), HasSubstr("did you mean '--json'?"));
    EXPECT_THAT(complaint("simulate m --probes p --add gravity:gz"), HasSubstr("error: palpate simulate: "));
}

TEST(CommandLine, EveryHelpTellsWhatEveryCommandTakes) {
    for (const char* command : {"run", "check", "mesh", "skeleton", "probe", "identify", "compare", "diagnose",
                                "improve", "effects", "simulate", "report", "new", "info", "export", "play"}) {
        const std::string help = palpate(std::string(command) + " --help").out;
        EXPECT_THAT(help, AllOf(HasSubstr("--json"), HasSubstr("--threads"), HasSubstr("--seed"))) << command;
    }
}

/// What a value is, in a user's words: no types of the parser, and none of its notes.
TEST(CommandLine, HelpIsInWords) {
    for (const char* command : {"", "run", "probe", "improve", "simulate", "skeleton", "play", "completion"}) {
        const std::string help = palpate(std::string(command) + " --help").out;
        for (const char* leak : {"FLOAT", "INT", "TEXT", "Excludes", "Needs", "REQUIRED", "Option Group", "Exactly"})
            EXPECT_THAT(help, Not(HasSubstr(leak))) << command;
    }
    EXPECT_THAT(palpate("probe --help").out,
                AllOf(HasSubstr("--young NUMBER"), HasSubstr("--law {linear,svk,neo-hooke}"), HasSubstr("--levels N"),
                      HasSubstr("(1 to 100)"), HasSubstr("--depth NUMBER,..."), HasSubstr("--output PATH")));
    EXPECT_THAT(palpate("improve --help").out,
                AllOf(HasSubstr("What to add, one of these:"), HasSubstr("--add EFFECT[:name=value,...]")));
}

/// On a terminal of any width.
TEST(ProgressLine, KeepsThePercentage) {
    for (const std::size_t columns : {20U, 44U, 79U, 200U}) {
        const std::string line = progress_line("locating the missing source", 0.5, 12, ", about 12 s left", columns);
        EXPECT_LE(line.size(), columns);
        EXPECT_THAT(line, HasSubstr("50 %"));
    }
    EXPECT_EQ(progress_line("fit", 0.5, 12, "", 79), "fit [============            ] 50 %, 12 s");
}

TEST(CommandLine, HelpBeginsWithExamples) {
    const std::string help = palpate("run --help").out;
    EXPECT_LT(help.find("Examples:"), help.find("Options:"));
}

TEST(CommandLine, RunTakesTheFlagsOfAllSettingsAndSkeletonThoseOfItsGroup) {
    const std::string run = palpate("run --help").out, skeleton = palpate("skeleton --help").out;
    for (const CaseSetting& setting : settings()) {
        if (setting.flag.empty()) continue;
        EXPECT_THAT(run, HasSubstr(setting.flag));
        if (setting.group == "Skeleton") {
            EXPECT_THAT(skeleton, HasSubstr(setting.flag));
        }
    }
    EXPECT_THAT(skeleton, Not(HasSubstr("--sphere-curve")));
}

}  // namespace
}  // namespace palpate::pipeline
