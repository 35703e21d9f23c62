// What the shell sees around the work: spelling, completion, the man page, a new case, what a file holds.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "mesh/errors.h"
#include "mesh/formats/surface/read_surface.h"
#include "mesh/formats/surface/surface_formats.h"
#include "mesh/text/atomic_file.h"
#include "mesh/topology/check_surface.h"
#include "pipeline/case/settings/read_case.h"
#include "pipeline/command_line/commands.h"
#include "pipeline/command_line/tree/command_tree.h"
#include "pipeline/command_line/tree/tree.h"
#include "pipeline/output/text/describe/describe.h"
#include "tests/temporary_folder.h"

namespace palpate::pipeline {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

CommandTree small_tree() {
    return {.what = "Does things.",
            .subcommands = {{.name = "run",
                             .what = "Runs it: all of [it].",
                             .examples = {"palpate run liver.stl"},
                             .positionals = {"INPUT"},
                             .positional_words = {},
                             .flags = {{{"-o", "--output"}, "Where it's written", true, {}},
                                       {{"--body"}, "What errors are judged on", true, {"reference", "skeleton"}},
                                       {{"--without"}, "What is left out", true, {"gravity", "contact"}, true}}},
                            {.name = "effects",
                             .what = "The catalogue.",
                             .examples = {},
                             .positionals = {"NAME"},
                             .positional_words = {"gravity", "contact"},
                             .flags = {}}},
            .common = {{{"--json"}, "As JSON", false, {}}}};
}

TEST(Spelling, NamesTheNearestVerbAndFlag) {
    EXPECT_THAT(spelling_error(small_tree(), {"rnu", "x.stl"}),
                AllOf(HasSubstr("'rnu'"), HasSubstr("did you mean 'run'")));
    EXPECT_THAT(spelling_error(small_tree(), {"run", "x.stl", "--ouput=y"}),
                AllOf(HasSubstr("'--ouput'"), HasSubstr("did you mean '--output'")));
    EXPECT_THAT(spelling_error(small_tree(), {"run", "x.stl", "-f"}), HasSubstr("no flag '-f'"));
    EXPECT_THAT(spelling_error(small_tree(), {"run", "x.stl", "--out", "y"}), HasSubstr("did you mean '--output'"));
    EXPECT_THAT(spelling_error(small_tree(), {"eff"}), HasSubstr("did you mean 'effects'"));
}

TEST(Spelling, FindsNothingWhereAllIsKnown) {
    EXPECT_THAT(spelling_error(small_tree(), {"run", "x.stl", "-o", "y", "--json", "--help", "-1"}), IsEmpty());
    EXPECT_THAT(spelling_error(small_tree(), {"--json"}), IsEmpty());
}

TEST(Completion, KnowsVerbsFlagsAndChoices) {
    for (const std::string& script : {bash_completion(small_tree()), zsh_completion(small_tree())}) {
        EXPECT_THAT(script, AllOf(HasSubstr("run"), HasSubstr("--output"), HasSubstr("reference skeleton"),
                                  HasSubstr("gravity contact"), HasSubstr("--json")));
    }
}

/// Bash itself completes with it.
TEST(Completion, WorksInBash) {
    const TemporaryFolder scratch;
    const auto script = scratch.write("completion", bash_completion(small_tree()));
    const auto complete = [&](const std::string& words, int at) {
        scratch.write("ask", "source " + script.string() + "\nCOMP_WORDS=(" + words +
                                 ")\nCOMP_CWORD=" + std::to_string(at) + "\n_palpate\necho \"${COMPREPLY[@]}\" > " +
                                 (scratch / "answer").string());
        EXPECT_EQ(std::system(("bash " + (scratch / "ask").string()).c_str()), 0);
        return mesh::read_text(scratch / "answer");
    };
    EXPECT_EQ(complete("palpate r", 1), "run\n");
    EXPECT_EQ(complete("palpate run --o", 2), "--output\n");
    EXPECT_EQ(complete("palpate run --body s", 3), "skeleton\n");
    EXPECT_EQ(complete("palpate effects g", 2), "gravity\n");
}

/// Zsh itself completes with it, at a terminal of its own: what stands on the line after the tab key.
TEST(Completion, WorksInZsh) {
    if (std::system("command -v zsh > /dev/null") != 0) GTEST_SKIP() << "there is no zsh";
    const TemporaryFolder scratch;
    scratch.write("_palpate", zsh_completion(small_tree()));
    scratch.write("gravel", "");
    const auto complete = [&](const std::string& typed) {
        const std::string at = scratch.path().string();
        // the terminal's own answer to ^T writes the line down
        scratch.write("ask", "zmodload zsh/zpty; cd " + at + R"(
zpty shell zsh -f -i
zpty -w shell "fpath=($PWD \$fpath); autoload -Uz compinit; compinit -u -D"
zpty -w shell 'tell() { print -r -- "$BUFFER" > answer; zle send-break }; zle -N tell; bindkey "^T" tell'
zpty -w shell "bindkey '^I' complete-word; print rea''dy"
zpty -r shell seen '*ready*'
zpty -w -n shell $')" + typed + R"(\t\C-T'
repeat 200; do [[ -s answer ]] && break; sleep 0.05; done
zpty -d shell
)");
        std::filesystem::remove(scratch / "answer");
        EXPECT_EQ(std::system(("timeout 60 zsh -f " + (scratch / "ask").string()).c_str()), 0);
        return mesh::read_text(scratch / "answer");
    };
    EXPECT_EQ(complete("palpate ru"), "palpate run \n");
    EXPECT_EQ(complete("palpate --json ru"), "palpate --json run \n") << "what is common may stand before the command";
    EXPECT_EQ(complete("palpate run --js"), "palpate run --json \n");
    EXPECT_EQ(complete("palpate run --body=s"), "palpate run --body=skeleton \n");
    EXPECT_EQ(complete("palpate run --body s"), "palpate run --body skeleton \n");
    EXPECT_EQ(complete("palpate effects --json gr"), "palpate effects --json gravity \n") << "--json takes no value";
    EXPECT_EQ(complete("palpate run --body skeleton --bo"), "palpate run --body skeleton --bo\n") << "said already";
    EXPECT_EQ(complete("palpate run --without contact --wi"), "palpate run --without contact --without=\n");
    EXPECT_EQ(complete("palpate run -o gr"), "palpate run -o gravel \n");
}

TEST(Completion, OffersOnceMoreWhatMayBeSaidAgain) {
    CLI::App app;
    CLI::App* probe = app.add_subcommand("probe", "Makes a set");
    std::vector<std::string> hidden;
    std::string law;
    probe->add_option("--hide", hidden)->expected(1)->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
    probe->add_option("--law", law);
    const CommandTree tree = tree_of(app);
    EXPECT_THAT(zsh_completion(tree), AllOf(HasSubstr("'*'--hide="), HasSubstr("'(--law)'--law=")));
}

TEST(ManPage, TellsEveryVerbWithItsFlags) {
    const std::string page = man_page(small_tree(), "1.2.3");
    EXPECT_THAT(page, AllOf(HasSubstr(".SH NAME"), HasSubstr(".SS palpate run INPUT"), HasSubstr("\\-o, \\-\\-output"),
                            HasSubstr("reference|skeleton"), HasSubstr("1.2.3"), HasSubstr(".SH EXIT STATUS")));
}

TEST(NewCase, IsReadBackAndHasAMesh) {
    const TemporaryFolder scratch;
    const commands::Outcome made = commands::new_case({scratch / "body"}, {});
    EXPECT_THAT(made.text, HasSubstr("Next: palpate run"));
    const Case c = read_case(scratch / "body/case.yaml", {});
    EXPECT_EQ(c.name, "my-body");
    EXPECT_TRUE(mesh::check_surface(mesh::read_surface(*c.mesh)).sound());
}

TEST(NewCase, OverwritesNothing) {
    const TemporaryFolder scratch;
    scratch.write("body/notes.txt", "mine");
    EXPECT_THROW(commands::new_case({scratch / "body"}, {}), InvalidInput);
    EXPECT_FALSE(std::filesystem::exists(scratch / "body/case.yaml"));
}

std::string told(const std::filesystem::path& file) {
    const Description description = describe(file);
    std::string all = description.kind + "\n";
    for (const std::string& line : description.lines) all += line + "\n";
    return all + description.next;
}

TEST(Info, TellsOfEachKindOfFile) {
    const TemporaryFolder scratch;
    commands::new_case({scratch / "body"}, {});
    EXPECT_THAT(told(scratch / "body"), AllOf(HasSubstr("a case, 'my-body'"), HasSubstr("E = 0.1 MPa")));
    EXPECT_THAT(told(scratch / "body/body.stl"), AllOf(HasSubstr("triangles"), HasSubstr("sound")));
    const auto table = scratch.write("posterior.csv",
                                     "parameter,link,unit,mean,sd,q025,q50,q975,prior_mean,prior_sd,informed\n"
                                     "elongation,,N/mm,2,0.1,1.8,2,2.2,3,1,1\n");
    EXPECT_THAT(told(table), AllOf(HasSubstr("1 of 1 are constrained"), HasSubstr("1.8 to 2.2")));
    const auto ladder =
        scratch.write("ladder.json",
                      R"({"format": "palpate-ladder/1", "verdict": "adequate", "steps": [{"effects": [], "rms_mm": 1.5,
           "held_out_rms_mm": null, "reference": null}]})");
    EXPECT_THAT(told(ladder), AllOf(HasSubstr("a ladder"), HasSubstr("1.5 mm rms")));
}

TEST(Info, SaysWhatIsKnownWhereItIsNone) {
    const TemporaryFolder scratch;
    const auto message = [](const std::filesystem::path& file) -> std::string {
        try {
            describe(file);
        } catch (const std::exception& e) {
            return e.what();
        }
        return "nothing";
    };
    EXPECT_THAT(message(scratch.write("notes.txt", "x")),
                AllOf(HasSubstr("known are a run folder"), HasSubstr("a body (" + mesh::surface_extensions())));
    EXPECT_THAT(message(scratch.write("other.json", R"({"format": "other/1"})")), HasSubstr("palpate-model/1"));
    EXPECT_THAT(message(scratch.write("other.csv", "a,b\n1,2\n")), HasSubstr("none of ours"));
    EXPECT_THAT(message(scratch / "missing"), HasSubstr("no such file"));
    EXPECT_THAT(message(scratch.path()), HasSubstr("the folder holds nothing"));
}

}  // namespace
}  // namespace palpate::pipeline
