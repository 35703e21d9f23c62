// `palpate check` of a measurement set: what it could show, on one page, before any fit.

#include <gmock/gmock.h>

#include <memory>

#include "mesh/text/atomic_file.h"
#include "pipeline/command_line/commands.h"
#include "pipeline/output/text/preflight.h"
#include "tests/messages.h"
#include "tests/temporary_folder.h"

namespace palpate::pipeline {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

/// A bar of 100 x 20 x 20 mm that is pressed at three places, read to 0.05 mm, unloaded too.
class CheckedSet : public testing::Test {
protected:
    static void SetUpTestSuite() {
        folder_ = std::make_unique<TemporaryFolder>();
        const commands::NewOptions made{.folder = folder() / "new"};
        commands::new_case(made, {});
        commands::ProbeCommandOptions probed{
            .input = folder() / "new/body.stl", .output = folder() / "set", .overrides = {}};
        probed.synthesis.hide = {"none"};
        probed.overrides.set("volume.edge_length", 12);
        probed.overrides.set("probing.probes", 4);
        probed.overrides.set("probing.markers", 20);
        commands::probe(probed, {});
    }
    static void TearDownTestSuite() { folder_.reset(); }
    static std::filesystem::path folder() { return folder_->path(); }
    static commands::Outcome check(const commands::CheckOptions& options) { return commands::check(options, {}); }
    static commands::CheckOptions of_set(std::vector<std::string> expected = {}) {
        return {.input = folder() / "set", .expected = std::move(expected), .overrides = {}};
    }

private:
    static inline std::unique_ptr<TemporaryFolder> folder_;
};

TEST_F(CheckedSet, IsNotJudgedUnlessItIsAsked) {
    const commands::Outcome outcome = check(of_set());
    EXPECT_FALSE(outcome.json.contains("preflight"));
    EXPECT_THAT(outcome.text, HasSubstr("-o check.html"));
}

TEST_F(CheckedSet, TellsWhatItCouldName) {
    const commands::Outcome outcome = check(of_set({"gravity"}));
    EXPECT_EQ(outcome.code, commands::done);
    const nlohmann::json& preflight = outcome.json["preflight"];
    ASSERT_TRUE(preflight.is_object());
    EXPECT_THAT(outcome.text, AllOf(HasSubstr("Before any fit"), HasSubstr("gravity"), HasSubstr("Young's modulus")));
    for (const nlohmann::json& effect : preflight["effects"]) {
        if (effect["effect"] != "pressure") continue;
        EXPECT_EQ(effect["can_be_named"], "no");
        EXPECT_EQ(effect["why_not"], "the body has no closed cavity");
    }
}

TEST_F(CheckedSet, HasExitCode5WhereWhatIsExpectedCannotBeShown) {
    EXPECT_EQ(check(of_set({"gravity"})).code, commands::done);
    const commands::Outcome outcome = check(of_set({"gravity", "pressure"}));
    EXPECT_EQ(outcome.code, commands::not_met);
    EXPECT_THAT(outcome.text, AllOf(HasSubstr("Not as expected: The set cannot show pressure"),
                                    HasSubstr("the body has no closed cavity"), Not(HasSubstr("cannot show gravity"))));
    EXPECT_EQ(outcome.json["expected"][1]["shown"], false);
}

TEST_F(CheckedSet, WritesOnePage) {
    commands::CheckOptions options = of_set();
    options.output = folder() / "check.html";
    const commands::Outcome outcome = check(options);
    EXPECT_THAT(outcome.text, HasSubstr("Written: "));
    const std::string page = mesh::read_text(options.output);
    EXPECT_THAT(page, AllOf(HasSubstr("<canvas id=\"canvas\""), HasSubstr("What could be named"),
                            HasSubstr("next hour in the lab"), HasSubstr("Which readings look off"),
                            HasSubstr("Which states repeat"), HasSubstr("name=\"generator\" content=\"palpate\"")));
    // nothing is fetched from anywhere
    EXPECT_THAT(page, AllOf(Not(HasSubstr("src=\"http")), Not(HasSubstr("<link rel=\"stylesheet\""))));
    // the picture comes first
    EXPECT_LT(page.find("<canvas"), page.find("class=\"lead\""));
    check(options);  // a page of its own is replaced
}

TEST_F(CheckedSet, WritesThePageOfAMeshToo) {
    commands::CheckOptions options{.input = folder() / "new/body.stl", .overrides = {}};
    options.output = folder() / "mesh.html";
    check(options);
    EXPECT_THAT(mesh::read_text(options.output),
                AllOf(HasSubstr("The surface is sound"), Not(HasSubstr("What could be named"))));
}

TEST_F(CheckedSet, RefusesToExpectWhatNobodyKnowsOrMeasured) {
    EXPECT_THAT(message_of([] { check(of_set({"gravitty"})); }), AllOf(HasSubstr("gravitty"), HasSubstr("gravity")));
    EXPECT_THAT(
        message_of([] { check({.input = folder() / "new/body.stl", .expected = {"gravity"}, .overrides = {}}); }),
        AllOf(HasSubstr("--expect"), HasSubstr("this is a mesh")));
}

/// A share in per cent, a ratio with what it is a ratio to.
TEST(Preflight, BareNumbersSayWhatTheyAreOf) {
    const auto in_words = [](const char* name, double value, const char* effect) {
        return own_strength({{"name", name}, {"value", value}, {"unit", "1"}, {"at_most", false}}, effect);
    };
    EXPECT_EQ(in_words("force-gain", 0.114, "force-gain"), "gain error 11 %");
    EXPECT_EQ(in_words("probe3", 0.114, "force-gain"), "gain error 11 %");
    EXPECT_EQ(in_words("prestress", 0.0323, "prestress"), "0.032 x shear modulus");
    EXPECT_EQ(in_words("growth", 0.0079, "swelling"), "0.79 % growth");
    EXPECT_EQ(in_words("ratio", 1.8, "inclusion"), "ratio 1.8");
}

/// The terminal and the page have the same cell.
TEST(Preflight, WithoutANumberOfItsOwnAThresholdIsOfThePrior) {
    nlohmann::json effect{{"effect", "contact"}, {"least", {{"of_prior", 0.59}, {"own", nullptr}}}};
    EXPECT_EQ(threshold_in_words(effect), "0.59 of its prior");
    effect["least"]["of_prior"] = nullptr;
    EXPECT_EQ(threshold_in_words(effect), "–");
}

TEST(Preflight, SaysHowMuchStrongerAnEffectWouldHaveToBe) {
    const nlohmann::json own{{"name", "gravity"}, {"value", 9810.0}, {"unit", "mm/s^2"}, {"at_most", false}};
    const nlohmann::json effect{{"effect", "gravity"},
                                {"share", 0.1},
                                {"why_not", "it would have to be 3 times as strong as its prior expects"},
                                {"prior", {{"own", own}}}};
    const std::string why = why_not_shown({{"effects", {effect}}}, "gravity");
    EXPECT_EQ(why,
              "The set cannot show gravity at the strength of its prior, 9810 mm/s^2: it would have to be 3 times as "
              "strong as its prior expects.");
}

TEST_F(CheckedSet, TellsWhatARunOfItWouldTake) {
    commands::CheckOptions options = of_set();
    options.cost = true;
    const nlohmann::json cost = check(options).json["cost"];
    std::vector<std::string> stages;
    for (const nlohmann::json& stage : cost["stages"]) stages.push_back(stage["stage"]);
    EXPECT_THAT(stages, testing::ElementsAre("mesh", "skeleton", "identify", "compare", "diagnose", "improve"));
    EXPECT_GT(cost["most_seconds"], cost["seconds"]);
    EXPECT_TRUE(cost["fits"]);
    EXPECT_GT(cost["reference_nodes"], 100);
}

/// Of a body with such edges [mm].
commands::Outcome cost_of_body(const std::filesystem::path& body, double edge) {
    commands::CheckOptions options{.input = body, .cost = true, .overrides = {}};
    options.overrides.set("volume.edge_length", edge);
    return commands::check(options, {});
}

TEST_F(CheckedSet, ALargeBodyIsCountedFromACoarserOne) {
    const std::filesystem::path body = folder() / "new/body.stl";
    const nlohmann::json cost = cost_of_body(body, 1.5).json["cost"];
    commands::MeshOptions meshed{.input = body, .output = folder() / "bar.vtu", .overrides = {}};
    meshed.overrides.set("volume.edge_length", 1.5);
    const double nodes = commands::mesh_body(meshed, {}).json["nodes"];
    EXPECT_GT(nodes, 25000);  // else the bar was meshed as it is
    EXPECT_NEAR(cost["nodes"].get<double>(), nodes, 0.15 * nodes);
}

TEST_F(CheckedSet, ABodyThatDoesNotFitIsToldWithWhatToDo) {
    const commands::Outcome outcome = cost_of_body(folder() / "new/body.stl", 0.05);
    EXPECT_FALSE(outcome.json["cost"]["fits"]);
    EXPECT_GT(outcome.json["cost"]["nodes"], 1e8);
    EXPECT_THAT(outcome.text, AllOf(HasSubstr("does not fit"), HasSubstr("multigrid"), HasSubstr("mpirun -n N")));
}

}  // namespace
}  // namespace palpate::pipeline
