#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <string>

#include "tests/identify/measurement_set_files.h"
#include "tests/messages.h"

namespace palpate::identify {
namespace {

namespace fs = std::filesystem;

TEST_F(MeasurementSetFiles, AreReadAsTheContractSays) {
    const MeasurementSet set = read();
    EXPECT_EQ(set.name, "bar");
    EXPECT_EQ(set.folder, folder.path());
    EXPECT_EQ(set.rest_surface.vertices.colwise().maxCoeff(), Eigen::RowVector3d(100, 20, 20));
    ASSERT_EQ(set.supports.size(), 1u);
    EXPECT_TRUE(mesh::contains(set.supports, Vec3(0, 20, 0)));
    EXPECT_FALSE(set.density || set.gravity || set.position_noise || set.force_noise || set.material || set.continuous);

    ASSERT_EQ(set.markers.size(), 2u);
    EXPECT_EQ(set.markers[0].id, 7);
    EXPECT_FALSE(set.markers[0].anchor);
    EXPECT_EQ(set.markers[1].rest, Vec3(50, 10, 26));
    EXPECT_EQ(set.markers[1].anchor, Vec3(50, 10, 20));

    ASSERT_EQ(set.states.size(), 2u);
    EXPECT_TRUE(set.states[0].contacts.empty());
    const LoadState& loaded = set.states[1];
    EXPECT_EQ(loaded.probe, 1);
    EXPECT_EQ(loaded.time, 0.5);
    ASSERT_EQ(loaded.contacts.size(), 2u);
    EXPECT_EQ(loaded.contacts[0].point, Vec3(100, 10, 20));
    EXPECT_EQ(loaded.contacts[0].force, Vec3(0, 0, -2));
    EXPECT_EQ(loaded.contacts[0].radius, 3);
    EXPECT_TRUE(loaded.gravity.array().isNaN().all());
    EXPECT_TRUE(std::isnan(loaded.pressure));
    EXPECT_TRUE(loaded.field.empty());

    ASSERT_EQ(loaded.readings.size(), 3u);
    EXPECT_EQ(loaded.readings[0].marker, 0);
    EXPECT_EQ(loaded.readings[0].sigma, 0.25);
    EXPECT_EQ(loaded.readings[1].marker, 1);
    EXPECT_TRUE(std::isnan(loaded.readings[1].position.x()));
    EXPECT_EQ(loaded.readings[1].position.z(), 25);
    EXPECT_TRUE(std::isnan(loaded.readings[1].sigma));
    EXPECT_EQ(loaded.readings[2].marker, -1);
}

TEST_F(MeasurementSetFiles, MeanTheSameInEveryUnit) {
    // The numbers stay, the unit changes: every length is a thousand times longer, every force a thousandth.
    const std::string rest_of_yaml =
        "density: 1050\n"
        "gravity: [0, 0, -9.81]\n"
        "noise: {position: 0.05, force: 0.01}\n"
        "material: {young: 0.3, poisson: 0.45}\n"
        "history: continuous\n";
    folder.write("states.csv", "probe,time,gx,gy,gz,pressure\n1,0.5,9.81,0,0,0.02\n");
    folder.write("set.yaml", yaml + rest_of_yaml);
    const MeasurementSet in_mm = read();
    std::string in_other_units = yaml + rest_of_yaml;
    in_other_units.replace(in_other_units.find("mm, force: N"), 12, "m, force: mN");
    folder.write("set.yaml", in_other_units);
    const MeasurementSet in_m = read();

    EXPECT_EQ(in_m.rest_surface.vertices, 1000 * in_mm.rest_surface.vertices);
    EXPECT_EQ(std::get<mesh::BoxRegion>(in_m.supports[0]).max, 1000 * std::get<mesh::BoxRegion>(in_mm.supports[0]).max);
    EXPECT_EQ(in_m.position_noise, 1000 * 0.05);
    EXPECT_EQ(in_m.force_noise, 1e-3 * 0.01);
    EXPECT_EQ(in_m.gravity, Vec3(0, 0, 1000 * -9.81));
    EXPECT_EQ(in_m.states[1].gravity, Vec3(1000 * 9.81, 0, 0));
    EXPECT_EQ(in_m.markers[1].rest, 1000 * in_mm.markers[1].rest);
    EXPECT_EQ(*in_m.markers[1].anchor, 1000 * *in_mm.markers[1].anchor);
    EXPECT_EQ(in_m.states[1].contacts[0].point, Vec3(1e5, 1e4, 2e4));
    EXPECT_EQ(in_m.states[1].contacts[0].force, Vec3(0, 0, -2e-3));
    EXPECT_EQ(in_m.states[1].contacts[0].radius, 3000);
    EXPECT_EQ(in_m.states[1].readings[0].position, Vec3(1e5, 1e4, 18e3));
    EXPECT_EQ(in_m.states[1].readings[0].sigma, 250);

    // Those have units of their own, whatever the length is.
    EXPECT_DOUBLE_EQ(*in_m.density, 1.05e-9);
    EXPECT_EQ(in_m.states[1].pressure, 0.02);
    EXPECT_EQ(in_m.material->young, 0.3);
    EXPECT_EQ(in_m.material->poisson, 0.45);
    EXPECT_TRUE(in_m.continuous);
}

TEST_F(MeasurementSetFiles, HoldEveryShapeOfSupport) {
    folder.write("clamp.csv", "x,y,z\n0,0,0\n0,20,20\n");
    folder.write("set.yaml", yaml +
                                 "  - sphere: {center: [50, 0, 0], radius: 2}\n"
                                 "  - plane: {point: [100, 0, 0], normal: [2, 0, 0], within: 0.5}\n"
                                 "  - points: {file: clamp.csv, within: 3}\n");
    const MeasurementSet set = read();
    ASSERT_EQ(set.supports.size(), 4u);
    EXPECT_TRUE(mesh::contains(set.supports[1], {50, 2, 0}));
    EXPECT_TRUE(mesh::contains(set.supports[2], {99.5, 7, 7}));
    EXPECT_TRUE(mesh::contains(set.supports[3], {3, 20, 20}));
}

TEST_F(MeasurementSetFiles, StatesMayComeFromStatesCsvAlone) {
    folder.write("states.csv", "probe,time,pressure\n9,0,0.01\n");
    folder.write("positions.csv", positions + "9,0,7,100,10,21,\n");
    const MeasurementSet set = read();
    ASSERT_EQ(set.states.size(), 3u);
    EXPECT_EQ(set.states[2].probe, 9);
    EXPECT_EQ(set.states[2].pressure, 0.01);
    EXPECT_EQ(set.states[2].readings.size(), 1u);
}

TEST_F(MeasurementSetFiles, FieldsAreFoundByTheNumbersInTheirNames) {
    write_field("field/0_0.0.vtu");
    write_field("field/1_5e-1.vtu");
    const MeasurementSet set = read();
    EXPECT_EQ(set.states[0].field, folder / "field/0_0.0.vtu");
    EXPECT_EQ(set.states[1].field, folder / "field/1_5e-1.vtu");
    EXPECT_EQ(field_file(set.states[1]), "field/1_0.5.vtu");
}

TEST_F(MeasurementSetFiles, WithAllFieldsNeedNoMarkers) {
    write_field("field/0_0.vtu");
    write_field("field/1_0.5.vtu");
    fs::remove(folder / "markers.csv");
    fs::remove(folder / "positions.csv");
    EXPECT_EQ(read().markers.size(), 0u);
}

TEST_F(MeasurementSetFiles, AnEmptyRowOfPositionsIsAMissingReading) {
    folder.write("positions.csv", positions + "0,0,3,,,,\n");
    EXPECT_EQ(read().states[0].readings.size(), 1u);
}

TEST_F(MeasurementSetFiles, TakeTimesInTheirOrder) {
    const std::string header = "probe,time,x,y,z,fx,fy,fz,radius\n";
    EXPECT_TRUE(says(refusal("probes.csv", header + "1,-2,0,10,10,0,0,-1,3\n"),
                     {"probes.csv, line 2, column time", "-2", "negative"}));
    EXPECT_TRUE(says(refusal("probes.csv", header + "1,3,0,10,10,0,0,-1,3\n0,0,0,0,0,0,0,0,0\n1,2,0,10,10,0,0,0,3\n"),
                     {"probes.csv, line 4, column time", "2 comes after 3 in probe 1"}));
}

TEST_F(MeasurementSetFiles, RefuseAMarkerFarOffItsAnchor) {
    folder.write("markers.csv", "marker,x,y,z,ax,ay,az\n3,100,10,5000,100,10,20\n7,0,0,0,,,\n");
    EXPECT_TRUE(says(message_of([&] { read(); }), {"markers.csv", "marker 3", "4980 mm off its anchor"}));
}

TEST_F(MeasurementSetFiles, AreReadByTheFolderOrItsYaml) {
    EXPECT_EQ(read_measurement_set(folder / "set.yaml").states.size(), 2u);
    EXPECT_TRUE(says(message_of<IoError>([&] { read_measurement_set(folder / "none"); }), {"none", "no such"}));
    fs::create_directories(folder / "empty");
    EXPECT_TRUE(says(message_of<IoError>([&] { read_measurement_set(folder / "empty"); }), {"empty", "no set.yaml"}));
}

TEST(MeasurementSets, OfOtherProgramsAreRead) {
    const char* data = std::getenv("PALPATE_DATA");
    if (!data) GTEST_SKIP() << "PALPATE_DATA names no folder of measurement sets";
    int count = 0;
    for (const auto& entry : fs::recursive_directory_iterator(data)) {
        if (entry.path().filename() != "set.yaml" || entry.path().string().find("/hostile/") != std::string::npos)
            continue;
        ++count;
        EXPECT_NO_THROW(EXPECT_FALSE(read_measurement_set(entry.path()).states.empty())) << entry.path();
    }
    EXPECT_GT(count, 0);
}

}  // namespace
}  // namespace palpate::identify
