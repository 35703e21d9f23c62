#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "tests/identify/rig_files.h"

namespace palpate::identify {
namespace {

// What a set of the second format says.

TEST_F(RigFiles, AreReadAsTheContractSays) {
    const MeasurementSet set = read();
    ASSERT_EQ(set.tools.size(), 2U);
    EXPECT_EQ(set.tools[0].name, "ball");
    EXPECT_EQ(std::get<mesh::SphereShape>(set.tools[0].shape).radius, 5);
    EXPECT_EQ(set.tools[0].origin, Vec3(60, 10, 26));
    EXPECT_FALSE(set.tools[0].bonded);
    EXPECT_TRUE(set.tools[1].bonded);
    EXPECT_EQ(set.tools[1].origin, Vec3(95, 10, 10));  // the centre of its box
    EXPECT_EQ(std::get<mesh::GripShape>(set.tools[1].shape).regions.size(), 1U);

    ASSERT_EQ(set.actuators.size(), 2U);
    EXPECT_EQ(std::get<Vec3>(std::get<mesh::PressureActuator>(set.actuators[0].kind).cavity), Vec3(30, 10, 6));
    const auto& cable = std::get<mesh::TendonActuator>(set.actuators[1].kind);
    EXPECT_EQ(cable.path.row(2).transpose(), Vec3(80, 10, 12));
    EXPECT_FALSE(cable.by_length);
    EXPECT_EQ(set.reaction_noise, 0.02);
    EXPECT_EQ(set.moment_noise, 1);  // N*mm

    // probe 2 at time 0 stands in actuations.csv alone, and comes before the grip's motion
    ASSERT_EQ(set.states.size(), 4U);
    const LoadState &pressed = set.states[0], &bent = set.states[1], &pulled = set.states[2], &drained = set.states[3];
    EXPECT_EQ(std::pair(bent.probe, bent.time), std::pair(2, 0.0));
    EXPECT_EQ(std::pair(pulled.probe, pulled.time), std::pair(2, 1.0));

    ASSERT_EQ(pressed.motions.size(), 1U);
    EXPECT_EQ(pressed.motions[0].tool, 0);
    EXPECT_EQ(pressed.motions[0].translation, Vec3(0, 0, -2));
    ASSERT_EQ(pressed.reactions.size(), 1U);
    EXPECT_TRUE(std::isnan(pressed.reactions[0].force.x()));
    EXPECT_EQ(pressed.reactions[0].force.z(), -0.5);
    EXPECT_EQ(pressed.reactions[0].sigma, 0.1);

    EXPECT_TRUE(std::isnan(pulled.motions[0].translation.y()));  // free
    EXPECT_EQ(pulled.motions[0].translation.z(), 0);             // held
    EXPECT_TRUE(std::isnan(pulled.motions[0].rotation.x()));
    EXPECT_DOUBLE_EQ(pulled.motions[0].rotation.z(), std::numbers::pi / 2);
    EXPECT_EQ(pulled.reactions[0].moment.y(), 250);
    EXPECT_TRUE(std::isnan(pulled.reactions[0].sigma));

    EXPECT_EQ(bent.actuations[0].actuator, 1);
    EXPECT_EQ(bent.actuations[0].value, 4);
    EXPECT_EQ(bent.actuations[0].sigma, 0.5);
    EXPECT_DOUBLE_EQ(drained.actuations[0].value, -0.005);  // a vacuum of 5 kPa

    ASSERT_EQ(pressed.readings.size(), 1U);  // from rest: positions
    EXPECT_FALSE(pressed.readings[0].since);
    EXPECT_EQ(pressed.readings[0].position.z(), 19.5);
    EXPECT_TRUE(std::isnan(pressed.readings[0].position.y()));
    EXPECT_EQ(pressed.readings[0].sigma, 0.125);
    EXPECT_TRUE(set.notes.empty());
}

TEST_F(RigFiles, MeanTheSameInEveryUnit) {
    mesh::Surface rest = with_hollow(bar(), chamber());
    rest.vertices /= 1000;
    mesh::write_surface(folder / "rest.vtp", rest);
    folder.write("set.yaml",
                 "format: palpate-measurements/2\n"
                 "units: {length: m, force: mN, angle: rad, pressure: mbar}\n"
                 "rest_surface: rest.vtp\n"
                 "supports: [{box: {min: [0, -1, -1], max: [0.0001, 1, 1]}}]\n"
                 "tools:\n"
                 "  - {name: ball, shape: {sphere: {radius: 0.005}}, at: [0.06, 0.01, 0.026], contact: frictionless}\n"
                 "  - {name: grip, region: {box: {min: [0.089, -1, -1], max: [0.101, 1, 1]}}}\n"
                 "actuators:\n"
                 "  - {name: chamber, kind: pressure, cavity: {near: [0.03, 0.01, 0.006]}}\n"
                 "  - {name: cable, kind: tendon, path: [[0, 0.01, 0.015], [0.08, 0.01, 0.012]], by: length}\n"
                 "noise: {position: 1e-5, reaction: 20, moment: 1}\n"
                 "correlated: {position: 0.002}\n");
    folder.write("markers.csv", "marker,x,y,z\n7,0.08,0.01,0.02\n3,0.05,0.01,0\n");
    folder.write("displacements.csv", "probe,time,marker,ux,uy,uz\n1,0,7,0.001,0,0\n");
    folder.write("motions.csv", "probe,time,tool,x,y,z,rz\n1,0,ball,0,0,-0.002,\n2,1,grip,0.001,0,0,0.5\n");
    folder.write("reactions.csv", "probe,time,tool,fx,fy,fz,mz,sigma\n2,1,grip,2,0,0,3,1\n");
    folder.write("actuations.csv", "probe,time,actuator,value\n2,0,cable,0.004\n3,0,chamber,50\n");
    const MeasurementSet set = read();
    EXPECT_DOUBLE_EQ(std::get<mesh::SphereShape>(set.tools[0].shape).radius, 5);
    EXPECT_DOUBLE_EQ(set.tools[0].origin.z(), 26);
    EXPECT_DOUBLE_EQ(std::get<mesh::TendonActuator>(set.actuators[1].kind).path(1, 0), 80);
    EXPECT_DOUBLE_EQ(*set.reaction_noise, 0.02);
    EXPECT_DOUBLE_EQ(*set.moment_noise, 1);  // mN*m, as nothing else is said
    EXPECT_DOUBLE_EQ(*set.position_correlation, 2);
    EXPECT_DOUBLE_EQ(set.states[0].motions[0].translation.z(), -2);
    EXPECT_TRUE(std::isnan(set.states[0].motions[0].rotation.z()));
    EXPECT_EQ(set.states[0].motions[0].rotation.x(), 0);  // no such column: held
    EXPECT_EQ(set.states[2].motions[0].rotation.z(), 0.5);
    EXPECT_DOUBLE_EQ(set.states[2].reactions[0].force.x(), 0.002);
    EXPECT_DOUBLE_EQ(set.states[2].reactions[0].moment.z(), 3);
    EXPECT_DOUBLE_EQ(set.states[2].reactions[0].sigma, 0.001);
    EXPECT_DOUBLE_EQ(set.states[1].actuations[0].value, 4);        // mm
    EXPECT_DOUBLE_EQ(set.states[3].actuations[0].value, 0.005);    // MPa
    EXPECT_DOUBLE_EQ(set.states[0].readings[0].position.x(), 81);  // mm
}

TEST_F(RigFiles, AChamberOfItsOwnIsCarvedOutOfTheBodyOnce) {
    const double before = mesh::signed_volume(read().rest_surface);
    folder.write("set.yaml", with("actuators:\n",
                                  "actuators:\n  - {name: tube, kind: pressure, cavity: {surface: chamber.stl}}\n"));
    const mesh::Surface outward = mesh::make_box({50, 6, 10}, {70, 14, 16}, {2, 2, 2});
    mesh::Surface inward = outward;
    inward.triangles = outward.triangles.rowwise().reverse();
    for (const mesh::Surface& tube : {outward, inward}) {
        mesh::write_surface(folder / "chamber.stl", tube);
        const MeasurementSet set = read();
        EXPECT_NEAR(mesh::signed_volume(set.rest_surface), before - 960, 1e-6);
        EXPECT_TRUE(says(set.notes.front(), {"'tube'", "960 mm^3", "carved out"}));

        write_measurement_set(folder / "copy", set);
        const MeasurementSet copy = read_measurement_set(folder / "copy");
        EXPECT_EQ(copy.rest_surface.triangles.rows(), set.rest_surface.triangles.rows());
        std::filesystem::remove_all(folder / "copy");
    }
}

TEST_F(RigFiles, AChamberThatTheRestSurfaceShowsIsLeftAsItIs) {
    const Eigen::Index triangles = read().rest_surface.triangles.rows();
    folder.write("set.yaml", with("near: [30, 10, 6]", "surface: chamber.stl"));
    mesh::write_surface(folder / "chamber.stl", mesh::make_box({20, 6, 3}, {40, 14, 9}, {5, 3, 1}));
    EXPECT_EQ(read().rest_surface.triangles.rows(), triangles);
}

TEST_F(RigFiles, ATendonThatIsNotGuidedForLongIsNoted) {
    folder.write("set.yaml", with("[[0, 10, 15], [50, 10, 15], [80, 10, 12]]", "[[0, 10, 17], [80, 10, 17]]"));
    const MeasurementSet set = read();
    ASSERT_EQ(set.notes.size(), 1U);
    EXPECT_TRUE(says(set.notes.front(), {"'cable'", "80 mm from point 1", "27 times", "guided"}));
}

TEST_F(RigFiles, OfOneBodyMustTellTheOrderOfItsStates) {
    const std::string continuous = yaml + "history: continuous\n";
    EXPECT_TRUE(says(refusal("set.yaml", continuous),
                     {"actuations.csv, line 2", "motions.csv has no row", "history: continuous", "probes.csv"}));
    folder.write("set.yaml", continuous);
    folder.write("probes.csv",
                 "probe,time,x,y,z,fx,fy,fz,radius\n3,0,0,0,0,0,0,0,0\n1,0,0,0,0,0,0,0,0\n2,0,0,0,0,0,0,0,0\n"
                 "2,1,0,0,0,0,0,0,0\n");
    const MeasurementSet set = read();
    ASSERT_EQ(set.states.size(), 4U);
    EXPECT_EQ(set.states[0].probe, 3);
    EXPECT_EQ(set.states[0].actuations.size(), 1U);
    EXPECT_EQ(set.states[3].motions.size(), 1U);
}

TEST_F(RigFiles, OfOneBodyTellTimeInItsOrder) {
    folder.write("set.yaml", yaml + "history: continuous\n");
    folder.write("actuations.csv", "probe,time,actuator,value\n1,0,cable,4\n");
    folder.write("displacements.csv", "probe,time,marker,ux,uy,uz\n1,0,7,0,0,1\n");
    EXPECT_NO_THROW(read());
    EXPECT_TRUE(says(refusal("motions.csv", motions + "2,0.5,grip,1,0,0,0,0,0\n"),
                     {"motions.csv", "probe 2 at time 0.5", "comes after 1"}));
}

TEST_F(RigFiles, WithoutAPlaceRestAtTheOriginWhichIsSaid) {
    folder.write("set.yaml", with(", at: [60, 10, 26]", ""));
    folder.write("motions.csv", "probe,time,tool,x,y,z\n1,0,ball,60,10,24\n2,1,grip,1,0,0\n");
    const MeasurementSet set = read();
    EXPECT_EQ(set.tools[0].origin, Vec3(0, 0, 0));
    ASSERT_EQ(set.notes.size(), 1U);
    EXPECT_TRUE(says(set.notes[0], {"'ball' has no 'at'", "origin", "motions.csv"}));
    write_measurement_set(folder / "copy", set);
    EXPECT_EQ(read_measurement_set(folder / "copy").tools[0].origin, Vec3(0, 0, 0));
}

TEST_F(RigFiles, APunchPressesSquareToTheSurfaceBeforeIt) {
    // off the middle of the top: the direction to the body's centre would be slanted by 66 degrees
    folder.write("set.yaml", with("shape: {sphere: {radius: 5}}, at: [60, 10, 26]",
                                  "shape: {flat: {radius: 4}}, at: [75, 10, 20]"));
    const MeasurementSet set = read();
    // rounding of unit vectors alone
    EXPECT_LT((std::get<mesh::FlatShape>(set.tools[0].shape).axis - Vec3(0, 0, -1)).norm(), 1e-12);
    ASSERT_EQ(set.notes.size(), 1U);
    EXPECT_TRUE(says(set.notes[0], {"'ball' has no 'axis'", "(0, 0, -1)", "square to the surface"}));
}

TEST_F(RigFiles, SayWhatMeansNothing) {
    folder.write("motions.csv", "probe,time,tool,x,y,z,rz\n1,0,ball,0,0,-2,30\n2,1,grip,1,0,0,0\n");
    std::vector<std::string> notes = read().notes;
    ASSERT_EQ(notes.size(), 1U);
    EXPECT_TRUE(says(notes[0], {"'ball'", "without friction", "turns in 1 state mean nothing"}));

    // 20 mm up, less the radius and the 1 mm that it rests off the surface by; 5 mm are allowed
    folder.write("motions.csv", "probe,time,tool,x,y,z\n1,0,ball,0,0,20\n2,1,grip,1,0,0\n");
    notes = read().notes;
    ASSERT_EQ(notes.size(), 1U);
    EXPECT_TRUE(says(notes[0], {"'ball' comes no nearer than 21 mm", "one unit and one frame"}));
    folder.write("motions.csv", "probe,time,tool,x,y,z\n1,0,ball,0,0,3.9\n2,1,grip,1,0,0\n");
    EXPECT_TRUE(read().notes.empty());

    folder.write("motions.csv", "probe,time,tool,x,y,z\n2,1,grip,1,0,0\n1,0,grip,0,0,1\n");
    folder.write("reactions.csv", "probe,time,tool,fx,fy,fz\n2,1,grip,1,0,0\n");
    folder.write("actuations.csv", "probe,time,actuator,value\n3,0,cable,4\n");
    notes = read().notes;
    ASSERT_EQ(notes.size(), 2U);
    EXPECT_TRUE(says(notes[0], {"'ball' is away in all states"}));
    EXPECT_TRUE(says(notes[1], {"'chamber' is at 0 in all states"}));
}

}  // namespace
}  // namespace palpate::identify
