#include <gtest/gtest.h>

#include <string>

#include "tests/identify/measurement_set_files.h"
#include "tests/messages.h"

namespace palpate::identify {
namespace {

namespace fs = std::filesystem;

// What a user can get wrong in set.yaml.

TEST_F(MeasurementSetFiles, OfAnotherFormatAreRefused) {
    EXPECT_TRUE(says(refusal_of_yaml("measurements/1", "measurements/3"),
                     {"set.yaml, line 1", "palpate-measurements/3", "/1", "/2"}));
    EXPECT_TRUE(says(refusal_of_yaml("format: palpate-measurements/1\n", ""), {"set.yaml", "'format' is missing"}));
    EXPECT_TRUE(says(refusal_of_yaml("name:", "nam:"), {"line 2", "unknown field 'nam'", "did you mean 'name'"}));
}

TEST_F(MeasurementSetFiles, InUnknownUnitsAreRefused) {
    EXPECT_TRUE(
        says(refusal_of_yaml("length: mm", "length: inch"), {"line 3", "units.length", "'inch'", "'mm', 'cm', 'm'"}));
    EXPECT_TRUE(says(refusal_of_yaml("force: N", "force: kg"), {"units.force", "'kg'", "'N', 'mN'"}));
    EXPECT_TRUE(says(refusal_of_yaml("time: s", "time: ms"), {"units.time", "'ms'", "'s'"}));
    EXPECT_TRUE(says(refusal_of_yaml("time: s", "mass: kg"), {"unknown field 'units.mass'"}));
}

TEST_F(MeasurementSetFiles, WithoutASoundSupportAreRefused) {
    const std::string box = "box: {min: [0, -1, -1], max: [0.1, 21, 21]}";
    EXPECT_TRUE(says(refusal_of_yaml("supports:\n  - " + box, "gravity: [0, 0, 0]"), {"'supports' is missing"}));
    EXPECT_TRUE(says(refusal_of_yaml("\n  - " + box, " []"), {"line 5", "supports", "empty"}));
    EXPECT_TRUE(says(refusal_of_yaml("[0.1, 21, 21]", "[-0.1, 21, 21]"), {"line 6", "max", "min"}));
    EXPECT_TRUE(says(refusal_of_yaml(box, "cylinder: {radius: 1}"), {"line 6", "cylinder"}));
    EXPECT_TRUE(says(refusal_of_yaml(box, "plane: {point: [0, 0, 0], normal: [0, 0, 0], within: 1}"), {"normal"}));
    EXPECT_TRUE(says(refusal_of_yaml(box, "sphere: {center: [0, 0, 0], radius: -1}"), {"radius", "-1"}));
}

TEST_F(MeasurementSetFiles, ThatReachOutOfTheirFolderAreRefused) {
    for (const std::string path : {"../rest.vtp", "a/../../rest.vtp", "/etc/passwd"})
        EXPECT_TRUE(says(refusal_of_yaml("rest_surface: rest.vtp", "rest_surface: " + path),
                         {"line 4", path.c_str(), "folder"}));
    EXPECT_TRUE(
        says(refusal_of_yaml("box: {min: [0, -1, -1], max: [0.1, 21, 21]}", "points: {file: ../clamp.csv, within: 1}"),
             {"line 6", "../clamp.csv", "folder"}));
}

TEST_F(MeasurementSetFiles, ThatNameMissingFilesAreRefused) {
    folder.write("set.yaml",
                 "format: palpate-measurements/1\nrest_surface: rset.stl\nsupports: [{sphere: {center: [0, 0, 0], "
                 "radius: 1}}]\n");
    EXPECT_TRUE(says(message_of<IoError>([&] { read(); }), {"set.yaml, line 2", "rset.stl"}));
    for (const char* table : {"probes.csv", "markers.csv", "positions.csv"}) {
        const TemporaryFolder moved;
        folder.write("set.yaml", yaml);
        fs::rename(folder / table, moved / table);
        EXPECT_TRUE(says(message_of<IoError>([&] { read(); }), {table, "no such file"}));
        fs::rename(moved / table, folder / table);
    }
}

TEST_F(MeasurementSetFiles, WithImpossibleNumbersInTheYamlAreRefused) {
    EXPECT_TRUE(
        says(refusal("set.yaml", yaml + "noise: {position: 0}\n"), {"line 7", "noise.position", "outside [1e-09"}));
    EXPECT_TRUE(says(refusal("set.yaml", yaml + "noise: {force: -1}\n"), {"line 7", "noise.force", "-1"}));
    EXPECT_TRUE(
        says(refusal("set.yaml", yaml + "density: 1.05e-9\n"), {"line 7", "density", "1.05e-09", "[1, 30000]"}));
    EXPECT_TRUE(says(refusal("set.yaml", yaml + "history: old\n"), {"line 7", "history", "'fresh', 'continuous'"}));
    EXPECT_TRUE(says(refusal("set.yaml", yaml + "gravity: -9810\n"), {"line 7", "gravity", "list of three numbers"}));
    EXPECT_TRUE(says(refusal("set.yaml", yaml + "material: {young: 0}\n"), {"material.young", "outside [1e-09"}));
    EXPECT_TRUE(says(refusal("set.yaml", yaml + "material: {poisson: 0.5}\n"), {"material.poisson", "0.5"}));
    EXPECT_TRUE(says(refusal("set.yaml", yaml + "material: {yuong: 1}\n"), {"material.yuong", "did you mean 'young'"}));
}

// What a user can get wrong in the tables.

TEST_F(MeasurementSetFiles, WithoutStatesOrReadingsAreRefused) {
    EXPECT_TRUE(says(refusal("positions.csv", "probe,time,marker,x,y,z\n"), {"positions.csv", "no readings", "field"}));
    EXPECT_TRUE(says(refusal("probes.csv", "probe,time,x,y,z,fx,fy,fz,radius\n"), {"probes.csv", "no states"}));
}

TEST_F(MeasurementSetFiles, WithABadContactAreRefused) {
    EXPECT_TRUE(
        says(refusal("probes.csv", probes + "2,0,50,10,20,0,0,1,-3\n"), {"probes.csv, line 5", "radius", "-3"}));
    EXPECT_TRUE(says(refusal("probes.csv", probes + "2,0,50,,20,0,0,1,3\n"), {"line 5", "column y", "empty"}));
    EXPECT_TRUE(says(refusal("probes.csv", probes + "2,0,50,10,20,0,,1,3\n"), {"line 5", "column fy", "empty"}));
    EXPECT_TRUE(says(refusal("probes.csv", probes + "2.5,0,50,10,20,0,0,1,3\n"), {"line 5", "column probe", "2.5"}));
}

TEST_F(MeasurementSetFiles, WithBadMarkersAreRefused) {
    EXPECT_TRUE(
        says(refusal("markers.csv", markers + "7,0,10,20,,,\n"), {"markers.csv, line 4", "marker 7", "already"}));
    EXPECT_TRUE(says(refusal("markers.csv", markers + "8,0,10,20,1,,\n"), {"line 4", "marker 8", "ax, ay and az"}));
}

TEST_F(MeasurementSetFiles, WithReadingsOfUnknownThingsAreRefused) {
    EXPECT_TRUE(says(refusal("positions.csv", positions + "1,0.6,7,1,1,1,\n"),
                     {"positions.csv, line 6", "probe 1 at time 0.6", "probes.csv"}));
    EXPECT_TRUE(says(refusal("positions.csv", positions + "0,0,8,1,1,1,\n"), {"line 6", "marker 8", "markers.csv"}));
    EXPECT_TRUE(
        says(refusal("positions.csv", positions + "0,0,7,1,1,1,\n"), {"line 6", "marker 7", "already", "probe 0"}));
    EXPECT_TRUE(says(refusal("positions.csv", positions + "0,0,3,1,1,1,0\n"), {"line 6", "sigma", "below 1e-09"}));
}

TEST_F(MeasurementSetFiles, WithBadKnownLoadsAreRefused) {
    const std::string header = "probe,time,gx,gy,gz,pressure\n";
    EXPECT_TRUE(says(refusal("states.csv", header + "1,0.5,0,0,,\n"), {"states.csv, line 2", "gx, gy and gz"}));
    EXPECT_TRUE(says(refusal("states.csv", header + "0,0,,,,1\n0,0,,,,2\n"),
                     {"states.csv, line 3", "probe 0 at time 0", "already"}));
}

TEST_F(MeasurementSetFiles, WithFieldsOfUnknownStatesAreRefused) {
    folder.write("field/2_0.vtu", "");
    EXPECT_TRUE(says(message_of<InvalidInput>([&] { read(); }), {"2_0.vtu", "no state"}));
    fs::rename(folder / "field/2_0.vtu", folder / "field/last.vtu");
    EXPECT_TRUE(says(message_of<InvalidInput>([&] { read(); }), {"last.vtu", "<probe>_<time>.vtu"}));
    fs::rename(folder / "field/last.vtu", folder / "field/0_0.vtu");
    folder.write("field/0_0.0.vtu", "");
    EXPECT_TRUE(says(message_of<InvalidInput>([&] { read(); }), {"0_0", "same state"}));
}

TEST_F(MeasurementSetFiles, FarOffTheSurfaceAreRefusedWithAHintAtTheUnit) {
    // 5 % of the longest side are 5 mm: 8 mm off with a patch of 3 mm is the limit.
    folder.write("probes.csv", probes + "2,0,50,10,27.9,0,0,1,3\n");
    EXPECT_NO_THROW(read());
    EXPECT_TRUE(says(refusal("probes.csv", probes + "2,0,50,10,28.1,0,0,1,3\n"),
                     {"probe 2 at time 0", "8.1 mm", "8 mm", "units.length"}));
    EXPECT_TRUE(says(refusal("probes.csv", probes + "2,0,5000,1000,2000,0,0,1,3\n"), {"probe 2", "unit"}));
}

TEST_F(MeasurementSetFiles, MarkersMayLieInsideButNotFarOutside) {
    folder.write("markers.csv", markers + "8,50,10,10,,,\n");  // 10 mm below the surface
    EXPECT_NO_THROW(read());
    EXPECT_TRUE(says(refusal("markers.csv", markers + "8,50,10,30,,,\n"),
                     {"marker 8", "10 mm off", "5 mm", "units.length", "ax,ay,az"}));
    EXPECT_TRUE(says(refusal("markers.csv", markers + "8,50,10,30,50,10,30\n"), {"the anchor of marker 8", "10 mm"}));
}

}  // namespace
}  // namespace palpate::identify
