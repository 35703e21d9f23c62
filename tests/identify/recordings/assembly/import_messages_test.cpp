// What a user can get wrong in a map: one message each, with file, line, value, and what to do.

#include <utility>

#include "tests/identify/recordings/assembly/rig_of_a_bar.h"

namespace palpate::identify {
namespace {

using Words = std::vector<const char*>;

TEST_F(RigOfABar, RefusesKeysThatItDoesNotKnow) {
    EXPECT_TRUE(says(refusal("clock: {lag", "clok: {lag"), {"map.yaml, line", "clok", "did you mean 'clock'"}));
    EXPECT_TRUE(says(refusal("radius: 3", "raduis: 3"), {"raduis", "did you mean 'radius'"}));
    EXPECT_TRUE(says(refusal("{file: load.csv,", "{file: load.csv, probee: 2,"), {"probee", "did you mean 'probe'"}));
    EXPECT_TRUE(says(refusal("{lag: auto}", "{lags: auto}"), {"lags", "did you mean 'lag'"}));
}

TEST_F(RigOfABar, RefusesValuesThatMeanNothing) {
    const std::pair<std::pair<const char*, const char*>, Words> slips[]{
        {{"states: plateaus", "states: plateau"}, {"map.yaml, line", "'plateau'", "did you mean 'plateaus'"}},
        {{"states: plateaus", "states: every=fast"}, {"'every=fast'", "every=0.1s"}},
        {{"states: plateaus", "plateaus: {still: 3}"}, {"plateaus.still", "3"}},
        {{"clock: {lag: auto}", "clock: {lag: auto, trigger: load}"}, {"2 ways", "one is allowed"}},
        {{"clock: {lag: auto}", "clock: {lag: soon}"}, {"'soon'", "a finite number"}},
        {{"along: [0, 0, -1]", "along: [0, 0, 0]"}, {"length 0", "direction"}},
        {{"channel: load}", "channel: laod}"}, {"no file has a channel 'laod'", "did you mean 'load'"}},
        {{"{name: clamp1, at: [-10, 0, 0]}", "{name: clamp9, at: [-10, 0, 0]}"},
         {"fiducials", "no file has a point 'clamp9'"}},
        {{"{name: clamp2, at: [-10", "{name: clamp1, at: [-10"}, {"'clamp1'", "already"}},
        {{"states: plateaus", "register: often"}, {"'often'", "'auto', 'fiducials', 'icp', 'none'"}},
        {{"states: plateaus", "rest: never"}, {"'never'", "'first', 'none'"}},
        {{"states: plateaus", "rest: 7"}, {"no probe 7"}},
        {{"states: plateaus", "frame: {x: [1, 0, 0]}"}, {"1 axis", "two are needed"}},
        {{"states: plateaus", "frame: {x: [1, 0, 0], y: [1, 1, 0]}"}, {"right angles"}},
        {{"states: plateaus", "frame: {x: [1, 0, 0], y: [0, 1, 0], z: [0, 0, -1]}"}, {"left-handed"}},
        {{"states: plateaus", "frame: {x: [0, 0, 0], y: [0, 1, 0]}"}, {"axis of length 0"}},
        {{"states: plateaus", "rest: none\nreadings: displacements"}, {"count from the state at rest"}},
        {{"states: plateaus", "reactions: [{tool: punch, along: [1, 0, 0], channel: load}]"}, {"no 'tools'"}},
        {{"states: plateaus", "actuations: [{actuator: a, channel: load}]"}, {"no 'actuators'"}},
        {{"states: plateaus", "quantities: [{name: q, points: [], along: [1, 0, 0]}]"}, {"the list is empty"}},
        {{"{file: load.csv,", "{file: load.csv, values: {name: p, value: high},"}, {"'high'", "10 kPa"}},
        {{"{file: load.csv,", "{file: load.csv, values: {name: p, value: 3 kPascal},"}, {"'kPascal'", "no unit"}},
        {{"{file: points.csv,", "{file: points.csv, names: [a, b, c, d, e, f, g, h, i, i],"}, {"i"}}};
    for (const auto& [slip, words] : slips) {
        const std::string message = refusal(slip.first, slip.second);
        for (const char* word : words) EXPECT_TRUE(says(message, {word})) << slip.second;
    }
}

const std::string tools =
    "tools: [{name: punch, shape: {flat: {radius: 3}}, at: [100, 10, 21], axis: [0, 0, -1], contact: frictionless}]\n";

TEST_F(RigOfABar, RefusesChannelsOfToolsThatASetCannotTell) {
    EXPECT_TRUE(says(refusal("states: plateaus", tools + "reactions: [{tool: punch, along: [0, 1, 1], channel: load}]"),
                     {"oblique", "along one"}));
    EXPECT_TRUE(says(refusal("states: plateaus", tools + "reactions: [{tool: pnch, along: [0, 1, 0], channel: load}]"),
                     {"'pnch'", "did you mean 'punch'"}));
    EXPECT_TRUE(says(refusal("states: plateaus",
                             tools + "motions: [{tool: punch, along: [0, 0, 1], about: [0, 0, 1], channel: load}]"),
                     {"'along' and 'about'"}));
    EXPECT_TRUE(says(
        refusal("states: plateaus", tools + "motions: [{tool: punch, along: [0, 0, 1], channel: load, free: [w]}]"),
        {"'w'", "no coordinate"}));
    EXPECT_TRUE(says(refusal("states: plateaus", tools + "motions: [{tool: punch, points: [m1], channel: load}]"),
                     {"points", "or a channel"}));
}

TEST_F(RigOfABar, RefusesFilesThatAreNotThere) {
    change("file: load.csv", "file: laod.csv");
    EXPECT_TRUE(says(message_of<IoError>([&] { imported(); }), {"map.yaml, line", "no file 'laod.csv'"}));
    folder.write("map.yaml", map());
    const auto other = folder.write("other.csv", "time,a\n0,1\n1,2\n");
    EXPECT_TRUE(says(message_of([&] { import_set({.map = folder / "map.yaml", .files = {other}}); }),
                     {"other.csv", "the map says nothing of this file", "'points.csv'"}));
    EXPECT_TRUE(says(message_of<IoError>([&] { import_set({.map = folder / "map.yaml", .files = {folder / "none"}}); }),
                     {"none", "no such file"}));
    change("mesh: bar.stl", "mesh: bra.stl");
    EXPECT_TRUE(says(message_of<IoError>([&] { imported(); }), {"no file 'bra.stl'"}));
}

TEST_F(RigOfABar, NoticesUnitsThatDoNotFitTheMesh) {
    EXPECT_TRUE(
        says(refusal("{file: points.csv,", "{file: points.csv, unit: m,"), {"1e+03 times", "mm and m", "--unit"}));
    EXPECT_TRUE(says(refusal("{file: points.csv,", "{file: points.csv, unit: in,"), {"25.4 times", "inch"}));
    EXPECT_TRUE(says(message_of([&] {
                         folder.write("map.yaml", map());
                         import_set({.map = folder / "map.yaml", .files = {}, .unit = "cm"});
                     }),
                     {"10 times", "mm and cm"}));
}

TEST_F(RigOfABar, RefusesALagThatIsNotClear) {
    std::string noise_only = "time [s],load [N]\n";
    RandomStream random(1, 9, 1);
    for (int f = 0; f < 4000; ++f)
        noise_only += std::to_string(f / 1000.0) + "," + std::to_string(random.normal()) + "\n";
    folder.write("load.csv", noise_only);
    EXPECT_TRUE(says(message_of([&] { imported(); }), {"load.csv", "not clear", "trigger", "lag: 0.1"}));
    folder.write("load.csv", "time [s],load [N]\n0,1\n1,2\n2,1\n");
    EXPECT_TRUE(says(message_of([&] { imported(); }), {"3 samples are too few"}));
}

TEST_F(RigOfABar, RefusesATriggerThatOneSideHasNot) {
    EXPECT_TRUE(says(refusal("{lag: auto}", "{trigger: load, level: 0.5}"),
                     {"load.csv", "trigger 'load'", "1 edges here and 0 in points.csv"}));
}

TEST_F(RigOfABar, RefusesACommonColumnThatIsNone) {
    EXPECT_TRUE(says(refusal("{lag: auto}", "{common: frame}"), {"common column 'frame'", "points.csv"}));
    std::string text = map();
    text.replace(text.find("{lag: auto}"), 11, "{common: load}");
    text += "quantities: [{name: load, points: [m4], minus: [clamp1], along: [1, 0, 0]}]\n";
    folder.write("map.yaml", text);
    EXPECT_TRUE(says(message_of([&] { imported(); }), {"common column 'load'", "up and down"}));
}

TEST_F(RigOfABar, RefusesPointsWhoseOrderIsNotClear) {
    std::string text = map();
    const auto from = text.find("fiducials:"), to = text.find("forces:");
    text.erase(from, to - from);
    text.replace(text.find("{file: points.csv,"), 18, "{file: points.csv, order: unknown,");
    folder.write("map.yaml", text);
    EXPECT_TRUE(says(message_of([&] { imported(); }), {"unknown order", "the map has 0"}));
}

TEST_F(RigOfABar, RefusesValuesThatActWhereNothingMoves) {
    std::string text = map();
    text.replace(text.find("{file: points.csv,"), 18, "{file: points.csv, values: {name: p, value: 1},");
    text.replace(text.find("states: plateaus"), 16, "states: every=100s");
    folder.write("map.yaml", text);
    EXPECT_TRUE(says(message_of([&] { imported(); }), {"probe 1 has one state", "while: always"}));
}

TEST_F(RigOfABar, RefusesTwoOfOneName) {
    write_points("more.csv", true);
    change("  - {file: load.csv",
           "  - {file: more.csv, time: time, points: [{name: m4, at: [m4_x, m4_y, m4_z]}]}\n  - {file: "
           "load.csv");
    EXPECT_TRUE(says(message_of([&] { imported(); }), {"two points of probe 1 are called 'm4'", "names"}));
}

}  // namespace
}  // namespace palpate::identify
