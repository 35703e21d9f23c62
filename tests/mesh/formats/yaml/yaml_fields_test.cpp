#include "mesh/formats/yaml/yaml_fields.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <string>

#include "mesh/errors.h"
#include "tests/messages.h"
#include "tests/temporary_folder.h"

namespace palpate::mesh {
namespace {

YamlFields fields(const std::string& text) { return YamlFields::from_text(text, "some/case.yaml"); }

template <class Action>
std::string refusal(const std::string& text, Action&& action) {
    return message_of<InvalidInput>([&] { action(fields(text)); });
}
std::string refusal(const std::string& text) {
    return refusal(text, [](const YamlFields&) {});
}

TEST(YamlFields, ReadsEveryKind) {
    const YamlFields f = fields(
        "# settings\n"
        "name: \"liver: 3\"\n"
        "size: 1.5e2\n"
        "count: 12\n"
        "on: true\n"
        "g: [0, 0, -9810]\n"
        "corners: [[0, 1, 2], [3, 4, 5]]\n"
        "levels: [1, 2.5]\n"
        "words: [a, 'b c']\n"
        "noise: {position: 0.1}\n"
        "supports:\n"
        "  - box: {}\n"
        "  - sphere: {}\n");
    EXPECT_EQ(f.text("name"), "liver: 3");
    EXPECT_EQ(f.number("size"), 150);
    EXPECT_EQ(f.number("size", 150, 150), 150);
    EXPECT_EQ(f.integer("count", 1, 12), 12);
    EXPECT_TRUE(f.boolean("on"));
    EXPECT_EQ(f.vector("g"), Vec3(0, 0, -9810));
    EXPECT_EQ(f.vectors("corners").at(1), Vec3(3, 4, 5));
    EXPECT_EQ(f.numbers("levels"), (std::vector<double>{1, 2.5}));
    EXPECT_EQ(f.texts("words"), (std::vector<std::string>{"a", "b c"}));
    EXPECT_EQ(f.mapping("noise").number("position"), 0.1);
    const auto supports = f.mappings("supports");
    ASSERT_EQ(supports.size(), 2u);
    EXPECT_TRUE(supports[1].has("sphere"));
    EXPECT_EQ(f.mapping_or_mappings("supports").size(), 2u);
    EXPECT_EQ(f.mapping_or_mappings("noise").at(0).number("position"), 0.1);
    EXPECT_FALSE(f.has("nothing"));
    EXPECT_EQ(f.where("g"), "case.yaml, line 6, g");
    EXPECT_EQ(f.where("supports"), "case.yaml, line 11, supports");
    EXPECT_EQ(f.mapping("noise").where("position"), "case.yaml, line 10, noise.position");
    EXPECT_NO_THROW(f.finish());
}

TEST(YamlFields, RefusesValuesOfAnotherKind) {
    const std::string text = "n: twelve\nl: [1, two]\nm: {a: 1}\ne:\ni: 1.5\nw: .nan\n";
    EXPECT_TRUE(
        says(refusal(text, [](auto f) { f.number("n"); }), {"case.yaml, line 1, n", "'twelve'", "finite number"}));
    EXPECT_TRUE(says(refusal(text, [](auto f) { f.numbers("l"); }), {"line 2, l", "'two'"}));
    EXPECT_TRUE(says(refusal(text, [](auto f) { f.number("m"); }), {"line 3, m", "a mapping"}));
    EXPECT_TRUE(says(refusal(text, [](auto f) { f.text("e"); }), {"line 4, e", "nothing"}));
    EXPECT_TRUE(says(refusal(text, [](auto f) { f.integer("i", 0, 9); }), {"line 5, i", "'1.5'", "whole number"}));
    EXPECT_TRUE(says(refusal(text, [](auto f) { f.number("w"); }), {"line 6, w", "'.nan'"}));
    EXPECT_TRUE(says(refusal(text, [](auto f) { f.numbers("n"); }), {"line 1, n", "a list of numbers"}));
    EXPECT_TRUE(says(refusal(text, [](auto f) { f.texts("m"); }), {"line 3, m", "a list of texts"}));
    EXPECT_TRUE(says(refusal(text, [](auto f) { f.mapping("l"); }), {"line 2, l", "a list", "a mapping"}));
    EXPECT_TRUE(says(refusal(text, [](auto f) { f.mappings("m"); }), {"line 3, m", "a list of mappings"}));
    EXPECT_TRUE(says(refusal(text, [](auto f) { f.mappings("l"); }), {"line 2, l", "'1'", "a mapping"}));
}

TEST(YamlFields, RefusesValuesOutOfRange) {
    EXPECT_TRUE(says(refusal("x: 1.5", [](auto f) { f.number("x", 0, 1); }), {"line 1, x", "1.5", "[0, 1]"}));
    EXPECT_TRUE(says(refusal("x: 7", [](auto f) { f.integer("x", 0, 6); }), {"line 1, x", "7", "[0, 6]"}));
    EXPECT_TRUE(says(refusal("x: [1, 2]", [](auto f) { f.vector("x"); }), {"line 1, x", "2 numbers", "three"}));
    EXPECT_TRUE(says(refusal("x: meter",
                             [](auto f) {
                                 f.choice("x", {"metre", "mm"});
                             }),
                     {"line 1, x", "'meter'", "did you mean 'metre'", "'mm'"}));
    EXPECT_TRUE(says(refusal("x: yes", [](auto f) { f.boolean("x"); }), {"'yes'", "'true'", "'false'"}));
}

TEST(YamlFields, NamesAFieldThatIsMissing) {
    EXPECT_TRUE(says(refusal("a: 1\nb:\n  densty: 1\n", [](auto f) { f.mapping("b").number("density"); }),
                     {"case.yaml, line 3", "'b.density' is missing", "'densty'"}));
}

TEST(YamlFields, RefusesFieldsThatNobodyAskedFor) {
    const std::string text = "name: x\nnosie: {position: 1}\n";
    const std::string message = refusal(text, [](auto f) {
        f.text("name");
        f.has("noise");
        f.finish();
    });
    EXPECT_TRUE(says(message, {"case.yaml, line 2", "unknown field 'nosie'", "did you mean 'noise'", "'name'"}));
    EXPECT_TRUE(says(refusal("noise: {positon: 1}\n",
                             [](auto f) {
                                 f.mapping("noise").has("position");
                                 f.mapping("noise").finish();
                             }),
                     {"'noise.positon'", "did you mean 'position'"}));
}

TEST(YamlFields, RefusesWhatIsNoMapping) {
    EXPECT_TRUE(says(refusal(""), {"case.yaml", "empty"}));
    EXPECT_TRUE(says(refusal("- a\n- b\n"), {"case.yaml", "name: value"}));
    EXPECT_TRUE(says(refusal("a: [1, 2\nb: 3\n"), {"case.yaml, line", "no YAML"}));
    EXPECT_TRUE(says(refusal("a: 1\n---\nb: 2\n"), {"several documents"}));
    EXPECT_TRUE(says(refusal("a: 1\nb: 2\na: 3\n"), {"line 3", "'a' is given twice"}));
    EXPECT_TRUE(says(refusal("[1, 2]: 3\n"), {"line 1", "must be a word"}));
}

TEST(YamlFields, RefusesWhatIsNoUtf8) {
    EXPECT_TRUE(says(refusal("name: good\nnote: M\xFCnchen\n"), {"case.yaml, line 2", "0xFC", "UTF-8"}));
    EXPECT_TRUE(says(refusal("\xFF\xFE"
                             "n\0:\0"),
                     {"line 1", "0xFF"}));
    EXPECT_TRUE(says(refusal("a: \xC0\x80\n"), {"0xC0"}));      // longer than need be
    EXPECT_TRUE(says(refusal("a: \xED\xA0\x80\n"), {"0xED"}));  // half of a pair of UTF-16
    EXPECT_TRUE(says(refusal("a: \xE2\x82"), {"0xE2"}));        // cut off
    EXPECT_EQ(fields("name: München \xE2\x82\xAC \xF0\x9F\x98\x80").text("name"), "München € \xF0\x9F\x98\x80");
}

TEST(YamlFields, RefusesAliases) {
    // A billion laughs: each line holds nine times the line before.
    std::string bomb = "a0: &a0 [x, x, x, x, x, x, x, x, x]\n";
    for (int i = 1; i < 30; ++i)
        bomb += fmt::format("a{0}: &a{0} [*a{1}, *a{1}, *a{1}, *a{1}, *a{1}, *a{1}, *a{1}, *a{1}, *a{1}]\n", i, i - 1);
    EXPECT_TRUE(says(refusal(bomb), {"case.yaml, line 2", "aliases"}));
}

TEST(YamlFields, RefusesMoreThan32Levels) {
    const auto nested = [](int levels) { return "a: " + std::string(levels, '[') + std::string(levels, ']'); };
    EXPECT_NO_THROW(fields(nested(31)));  // the mapping itself is a level
    EXPECT_TRUE(says(refusal(nested(32)), {"line 1", "32 levels"}));
    EXPECT_TRUE(says(refusal(nested(500000)), {"32 levels"}));
}

TEST(YamlFields, RefusesHugeFiles) {
    const TemporaryFolder folder;
    const auto file = folder.write("case.yaml", "a: 1\n#" + std::string(1 << 20, '-'));
    EXPECT_TRUE(says(message_of<InvalidInput>([&] { YamlFields::from_file(file); }), {"case.yaml", "1048576"}));
    EXPECT_TRUE(
        says(message_of<IoError>([&] { YamlFields::from_file(folder / "none.yaml"); }), {"none.yaml", "no such file"}));
}

}  // namespace
}  // namespace palpate::mesh
