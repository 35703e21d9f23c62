// What a page that is played is made of. The page itself is used in play_test.py.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "mesh/errors.h"
#include "mesh/text/atomic_file.h"
#include "pipeline/command_line/commands.h"
#include "pipeline/play/play_data.h"
#include "pipeline/play/play_page.h"
#include "samples/lattice.h"
#include "skeleton/model/io/model_io.h"
#include "tests/messages.h"
#include "tests/places.h"
#include "tests/temporary_folder.h"

namespace palpate::pipeline {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

skeleton::Model lattice_in_the_hand() { return samples::make_lattice("cube", {3, 3, 2}, 1); }

/// Sliders reach half as far again as the set goes; states that moved tools are not replayed.
TEST(InTheHand, TakesTheActuatorsOfASet) {
    const TemporaryFolder scratch;
    const std::filesystem::path finger = std::filesystem::path(samples_folder) / "tendon-finger";
    skeleton::write_model(scratch / "model.json", lattice_in_the_hand());
    const nlohmann::json content = nlohmann::json::parse(play_data(scratch / "model.json", finger).content.dump());
    ASSERT_EQ(content["actuators"].size(), 1U);
    const nlohmann::json& tendon = content["actuators"][0];
    EXPECT_FALSE(content["judged"]);
    double largest = 0;
    int set = 0;
    for (const nlohmann::json& state : content["sets"][0]["states"]) {
        for (const nlohmann::json& one : state.value("settings", nlohmann::json::array())) {
            EXPECT_EQ(one[0], 0);
            largest = std::max(largest, one[1].get<double>());
            ++set;
        }
    }
    EXPECT_GT(set, 3);
    EXPECT_DOUBLE_EQ(tendon["high"].get<double>(), 1.5 * largest);
    EXPECT_EQ(tendon["low"], 0.0);
    EXPECT_EQ(tendon["unit"], "N");
    EXPECT_EQ(tendon["kind"], "tension");

    const std::filesystem::path phantom = std::filesystem::path(samples_folder) / "lump-phantom";
    const nlohmann::json pressed = nlohmann::json::parse(play_data(scratch / "model.json", phantom).content.dump());
    EXPECT_TRUE(pressed["sets"].empty());
    EXPECT_TRUE(pressed["actuators"].empty());
    EXPECT_THAT(pressed["notes"].dump(), HasSubstr("tools"));
}

/// Beside what finite elements tell of it, where the model has another number.
TEST(InTheHand, SaysHowWellAnEffectIsKnown) {
    const TemporaryFolder scratch;
    skeleton::Model model = lattice_in_the_hand();
    model.effects = {{"gravity", {{"gx", 0, "mm/s^2"}, {"gy", 12, "mm/s^2"}, {"gz", -9790, "mm/s^2"}}},
                     {"compliant-support", {{"stiffness", 2, "N/mm"}, {"turning", 1, "1"}}}};
    std::filesystem::create_directories(scratch / "run/identify");
    std::filesystem::create_directories(scratch / "run/diagnose");
    skeleton::write_model(scratch / "run/identify/model.json", model);
    mesh::write_text(scratch / "run/run.json", "{}");
    const auto numbers = [&] {
        const nlohmann::json effects =
            nlohmann::json::parse(play_data(scratch / "run", {}).content.dump())["models"][0]["effects"];
        return std::pair(effects[0]["numbers"], effects[1]["numbers"]);
    };
    EXPECT_EQ(numbers().first[2], "gz = -9790 mm/s^2") << "nothing was diagnosed";
    const nlohmann::json diagnosis = {{"explanation", {"gravity"}},
                                      {"ranking",
                                       {{{"effect", "gravity"},
                                         {"parameters",
                                          {{"gx", {{"value", 0.0}, {"sd", nullptr}}},
                                           {"gy", {{"value", 40.0}, {"sd", 30.0}}},
                                           {"gz", {{"value", -9790.0}, {"sd", 20.0}}}}}}}}};
    mesh::write_text(scratch / "run/diagnose/diagnosis.json", diagnosis.dump());
    EXPECT_EQ(numbers().first, nlohmann::json({"gx = 0 mm/s^2", "gy = 12 mm/s^2 (40 ± 30 in finite elements)",
                                               "gz = -9790 ± 20 mm/s^2"}));
    EXPECT_EQ(numbers().second[0], "stiffness = 2 N/mm") << "of this one nothing was";
}

/// Of the hundred and more numbers of a map its sentence tells what matters.
TEST(InTheHand, SumsUpAMap) {
    const TemporaryFolder scratch;
    skeleton::Model model = lattice_in_the_hand();
    skeleton::EffectRecord map{"map", {{"length", 5, "mm"}}};
    for (int i = 1; i <= 4; ++i) {
        for (const char* axis : {"x", "y", "z"})
            map.parameters.push_back({axis + std::to_string(i), *axis == 'x' ? 20.0 * i : 0.0, "mm"});
        map.parameters.push_back({"a" + std::to_string(i), i == 2 ? 1.2 : 0.0, "1"});
    }
    model.effects = {map};
    skeleton::write_model(scratch / "model.json", model);
    const nlohmann::json content = nlohmann::json::parse(play_data(scratch / "model.json", {}).content.dump());
    const nlohmann::json numbers = content["models"][0]["effects"][0]["numbers"];
    ASSERT_EQ(numbers.size(), 1U);
    EXPECT_THAT(numbers[0].get<std::string>(), HasSubstr("times its mean round (40, 0, 0) mm"));
}

TEST(InTheHand, WritesOnePageThatNeedsNoNetwork) {
    const TemporaryFolder scratch;
    skeleton::write_model(scratch / "model.json", lattice_in_the_hand());
    const commands::Outcome outcome =
        commands::play({.input = scratch / "model.json", .output = scratch / "page.html"}, {});
    EXPECT_EQ(outcome.code, commands::done);
    const std::string page = mesh::read_text(scratch / "page.html");
    EXPECT_EQ(outcome.json["bytes"].get<std::size_t>(), page.size());
    EXPECT_LT(page.size(), 5'000'000U);
    EXPECT_THAT(page, Not(AnyOf(HasSubstr("src=\"http"), HasSubstr("href=\"http"), HasSubstr("@import"))));
    EXPECT_THAT(page,
                AllOf(HasSubstr("<meta name=\"generator\" content=\"palpate\">"), HasSubstr("id=\"play-module\"")));
    // palpate's own page may be replaced, another one not
    EXPECT_NO_THROW(commands::play({.input = scratch / "model.json", .output = scratch / "page.html"}, {}));
    const auto other = scratch.write("other.html", "<html>mine</html>");
    EXPECT_THAT(message_of([&] { commands::play({.input = scratch / "model.json", .output = other}, {}); }),
                AllOf(HasSubstr("other.html"), HasSubstr("--force")));
}

TEST(InTheHand, SaysWhatCannotBePlayed) {
    const TemporaryFolder scratch;
    const auto message = [&](const std::filesystem::path& model) {
        return message_of([&] { commands::play({.input = model, .output = scratch / "page.html"}, {}); });
    };
    EXPECT_THAT(message_of<IoError>([&] { commands::play({.input = scratch / "none.json", .output = {}}, {}); }),
                AllOf(HasSubstr("none.json"), HasSubstr("does not exist")));
    std::filesystem::create_directory(scratch / "empty");
    EXPECT_THAT(message(scratch / "empty"), AllOf(HasSubstr("empty"), HasSubstr("no model.json")));
    mesh::write_text(scratch / "liver.stl", "solid\nendsolid\n");
    EXPECT_THAT(message(scratch / "liver.stl"), AllOf(HasSubstr("liver.stl"), HasSubstr("--pick")));
    skeleton::Model bare = lattice_in_the_hand();
    bare.surface = {};
    bare.skin.clear();
    skeleton::write_model(scratch / "bare.json", bare);
    EXPECT_THAT(message(scratch / "bare.json"), AllOf(HasSubstr("bare.json"), HasSubstr("skin")));
    skeleton::write_model(scratch / "model.json", lattice_in_the_hand());
    EXPECT_THAT(message_of([&] { commands::play({.input = scratch / "model.json", .output = scratch / "empty"}, {}); }),
                AllOf(HasSubstr("empty"), HasSubstr("page.html")));
    EXPECT_FALSE(std::filesystem::exists(scratch / "page.html"));
}

}  // namespace
}  // namespace palpate::pipeline
