#include <gtest/gtest.h>

#include <string>

#include "tests/identify/rig_files.h"

namespace palpate::identify {
namespace {

namespace fs = std::filesystem;

// What a user can get wrong about the format.

TEST_F(RigFiles, OfTheFirstFormatAreRefusedByTheirPart) {
    const std::string first = "format: palpate-measurements/1", second = "format: palpate-measurements/2";
    EXPECT_TRUE(says(refusal_of_yaml(second, first),
                     {"set.yaml, line 7", "'tools'", "second format", "'format: palpate-measurements/2'"}));
    const std::string plain =
        first + "\nrest_surface: rest.vtp\nsupports:\n  - box: {min: [0, -1, -1], max: [0.1, 21, 21]}\n";
    for (const char* part : {"actuators: []", "displacements: {}", "correlated: {}", "views: []", "regions: []"})
        EXPECT_TRUE(says(refusal("set.yaml", plain + part + "\n"), {"line 5", "second format"})) << part;
    EXPECT_TRUE(says(refusal("set.yaml", plain + "units: {angle: deg}\n"), {"units.angle", "second format"}));
    EXPECT_TRUE(says(refusal("set.yaml", plain + "noise: {reaction: 1}\n"), {"noise.reaction", "second format"}));
    EXPECT_TRUE(says(refusal("set.yaml", plain), {"motions.csv", "second format"}));
}

TEST_F(RigFiles, WithPartsThatAreAnnouncedAreRefusedByTheirName) {
    EXPECT_TRUE(says(refusal("set.yaml", yaml + "views: []\n"), {"'views'", "cannot fit it yet", "positions.csv"}));
    EXPECT_TRUE(says(refusal_of_yaml("reaction: 0.02", "image: 0.1"), {"noise.image", "cannot fit it yet"}));
    EXPECT_TRUE(says(refusal_of_yaml("reaction: 0.02", "surface: 0.1"), {"noise.surface", "cannot fit it yet"}));
    EXPECT_TRUE(
        says(refusal("set.yaml", yaml + "correlated: {surface: 3}\n"), {"correlated.surface", "cannot fit it yet"}));
    EXPECT_TRUE(says(refusal("images.csv", "probe,time,marker,view,u,v\n"), {"images.csv", "cannot fit it yet"}));
    folder.write("surfaces/1_0.ply", "");
    EXPECT_TRUE(says(message_of<InvalidInput>([&] { read(); }), {"surfaces", "cannot fit it yet", "positions.csv"}));
}

TEST_F(RigFiles, InUnknownUnitsAreRefused) {
    EXPECT_TRUE(says(refusal_of_yaml("deg", "grad"), {"units.angle", "'grad'", "'deg', 'rad'"}));
    EXPECT_TRUE(says(refusal_of_yaml("kPa", "psi"), {"units.pressure", "'psi'", "'mbar', 'bar', 'mmHg'"}));
    EXPECT_TRUE(says(refusal_of_yaml("N*m", "Nm"), {"units.moment", "'Nm'", "'N*mm', 'N*m'"}));
}

// What a user can get wrong in describing a tool.

TEST_F(RigFiles, WithToolsThatAreNoneAreRefused) {
    EXPECT_TRUE(says(refusal_of_yaml("name: grip", "name: ball"), {"line 9", "'ball'", "another one"}));
    EXPECT_TRUE(says(refusal_of_yaml("name: grip", "name: \"a,b\""), {"'a,b'", "without comma"}));
    EXPECT_TRUE(says(refusal_of_yaml("shape: {sphere: {radius: 5}}, ", ""), {"'ball' has neither", "'region'"}));
    EXPECT_TRUE(says(refusal_of_yaml("{sphere: {radius: 5}}", "{sphere: {radius: 5}, flat: {radius: 5}}"),
                     {"2 kinds of shape", "one is needed"}));
    EXPECT_TRUE(says(refusal_of_yaml("{sphere: {radius: 5}}", "{ball: {radius: 5}}"), {"shape.ball"}));
    EXPECT_TRUE(says(refusal_of_yaml("radius: 5", "radius: -5"), {"radius", "-5 is outside"}));
    EXPECT_TRUE(says(refusal_of_yaml("contact: frictionless", "contact: rough"), {"'rough'", "'frictionless'"}));
    EXPECT_TRUE(says(refusal_of_yaml("contact: bonded", "contact: frictionless"), {"a grip", "lets it go"}));
    EXPECT_TRUE(
        says(refusal_of_yaml("sphere: {radius: 5}}", "flat: {radius: 5}}, axis: [0, 0, 0]"), {"axis", "length 0"}));
    EXPECT_TRUE(says(refusal_of_yaml("{box: {min: [89, -1, -1], max: [101, 21, 21]}}", "[]"), {"empty", "a grip"}));
    EXPECT_TRUE(says(refusal_of_yaml("box: {min: [89, -1, -1], max: [101, 21, 21]}",
                                     "plane: {point: [0, 0, 90], normal: [0, 0, 1], within: 1}"),
                     {"no vertex of the rest surface", "unit"}));
}

TEST_F(RigFiles, WithOpenToolsAreRefused) {
    mesh::Surface box = mesh::make_box({58, 8, -9}, {66, 12, -1}, {1, 1, 1});
    box.triangles.conservativeResize(box.triangles.rows() - 1, 3);
    mesh::write_surface(folder / "punch.stl", box);
    EXPECT_TRUE(says(refusal_of_yaml("sphere: {radius: 5}}, at: [60, 10, 26]", "mesh: punch.stl}"),
                     {"shape.mesh", "'punch.stl' is not closed", "3 open edges", "tool 'ball'"}));
    EXPECT_TRUE(says(refusal_of_yaml("sphere: {radius: 5}}, at: [60, 10, 26]", "mesh: ../punch.stl}"),
                     {"leads out of the set's folder"}));
}

TEST_F(RigFiles, WhoseToolsStartInsideTheBodyAreRefused) {
    // 2 % of the radius are 0.1 mm
    EXPECT_TRUE(says(refusal_of_yaml("60, 10, 26", "60, 10, 24.5"),
                     {"line 8", "'ball' starts 0.5 mm inside", "0.1 mm", "motions.csv"}));
    EXPECT_TRUE(says(refusal_of_yaml("60, 10, 26", "60, 10, 18"), {"starts 7 mm inside"}));
    EXPECT_EQ(refusal_of_yaml("60, 10, 26", "60, 10, 24.95"), "");
    EXPECT_TRUE(says(refusal_of_yaml("sphere: {radius: 5}}, at: [60, 10, 26]", "flat: {radius: 5}}, at: [60, 10, 19]"),
                     {"starts 1 mm inside"}));
    EXPECT_EQ(refusal_of_yaml("sphere: {radius: 5}}, at: [60, 10, 26]", "flat: {radius: 5}}, at: [60, 10, 20]"), "");
    mesh::write_surface(folder / "punch.stl", mesh::make_box({58, 8, -9}, {66, 12, 2}, {1, 1, 1}));
    EXPECT_TRUE(
        says(refusal_of_yaml("sphere: {radius: 5}}, at: [60, 10, 26]", "mesh: punch.stl}"), {"starts 2 mm inside"}));
}

// What a user can get wrong about what moves and what is read.

TEST_F(RigFiles, OfUnknownToolsAndActuatorsAreRefusedWithTheNearOne) {
    EXPECT_TRUE(says(refusal("motions.csv", "probe,time,tool,x,y,z\n1,0,bal,0,0,-2\n"),
                     {"motions.csv, line 2", "no tool 'bal'", "did you mean 'ball'", "'ball', 'grip'"}));
    EXPECT_TRUE(says(refusal("reactions.csv", "probe,time,tool,fx,fy,fz\n1,0,bowl,0,0,-2\n"),
                     {"reactions.csv, line 2", "no tool 'bowl'"}));
    EXPECT_TRUE(says(refusal("actuations.csv", "probe,time,actuator,value\n1,0,cabel,2\n"),
                     {"actuations.csv, line 2", "no actuator 'cabel'", "did you mean 'cable'"}));
    EXPECT_TRUE(says(refusal("actuations.csv", "probe,time,actuator,value\n1,0,,2\n"),
                     {"line 2", "column actuator", "A name is needed"}));
}

TEST_F(RigFiles, WithRowsTwiceAreRefused) {
    EXPECT_TRUE(says(refusal("motions.csv", motions + "1,0,ball,0,0,-2,0,0,0\n"),
                     {"motions.csv, line 4", "tool 'ball'", "probe 1 at time 0", "already"}));
    EXPECT_TRUE(
        says(refusal("reactions.csv", reactions + "1,0,ball,0,0,-2,0,0,0,\n"), {"line 4", "'ball'", "already"}));
    EXPECT_TRUE(
        says(refusal("actuations.csv", actuations + "2,0,cable,4,\n"), {"line 4", "actuator 'cable'", "already"}));
    EXPECT_TRUE(says(refusal("displacements.csv", displacements + "1,0,7,0,0,0,\n"),
                     {"displacements.csv, line 4", "marker 7", "already"}));
    folder.write("positions.csv", "probe,time,marker,x,y,z\n1,0,7,80,10,20\n");
    EXPECT_TRUE(says(message_of<InvalidInput>([&] { read(); }), {"displacements.csv, line 2", "marker 7", "already"}));
    folder.write("set.yaml", yaml + "displacements: {since: {probe: 2, time: 0}}\n");
    EXPECT_NO_THROW(read());  // a position, and how far it has moved since another state, are two readings
    EXPECT_TRUE(says(refusal("displacements.csv", displacements + "1,0,7,0,0,0,\n"), {"line 4", "displacement"}));
}

TEST_F(RigFiles, WithImpossibleRowsAreRefused) {
    EXPECT_TRUE(
        says(refusal("motions.csv", "probe,time,tool,x,y,z\n1,-1,ball,0,0,-2\n"), {"line 2", "-1 is negative"}));
    EXPECT_TRUE(says(refusal("motions.csv", "probe,time,tool,x,y,z,rx,ry,rz\n1,0,ball,,,,,,\n"),
                     {"line 2", "all coordinates", "left free"}));
    EXPECT_TRUE(says(refusal("actuations.csv", "probe,time,actuator,value\n2,0,cable,-4\n"),
                     {"line 2", "-4 would push", "0 where it is slack"}));
    EXPECT_TRUE(says(refusal("actuations.csv", "probe,time,actuator,value,sigma\n2,0,cable,4,0\n"),
                     {"line 2", "column sigma"}));
    EXPECT_TRUE(says(refusal("actuations.csv", "probe,time,actuator,value\n2,0,cable,\n"), {"column value", "empty"}));
    EXPECT_TRUE(says(refusal("reactions.csv", "probe,time,tool,fx,fy,fz,mx,my,mz,sigma\n1,0,ball,,,,1,,,0.1\n"),
                     {"line 2", "column sigma", "moments only", "noise.moment"}));
    EXPECT_TRUE(says(refusal("reactions.csv", "probe,time,tool,fx,fy,fz,sigma\n1,0,ball,1,,,0\n"),
                     {"line 2", "column sigma", "noise"}));
    EXPECT_TRUE(says(refusal("displacements.csv", "probe,time,marker,ux,uy,uz\n1,0,,1,0,0\n"),
                     {"line 2", "no marker", "number"}));
    EXPECT_TRUE(says(refusal("displacements.csv", "probe,time,marker,ux,uy,uz\n1,7,7,1,0,0\n"),
                     {"line 2", "no state of probe 1 at time 7"}));
}

TEST_F(RigFiles, WithReactionsOfWhatIsAwayAreRefused) {
    EXPECT_TRUE(says(refusal("reactions.csv", "probe,time,tool,fx,fy,fz\n3,0,ball,0,0,-2\n"),
                     {"reactions.csv, line 2", "tool 'ball' is away in probe 3 at time 0", "motions.csv"}));
    EXPECT_TRUE(says(refusal("reactions.csv", "probe,time,tool,fx,fy,fz\n5,0,ball,0,0,-2\n"),
                     {"line 2", "no state of probe 5"}));
}

TEST_F(RigFiles, WhoseToolsNothingAnswersAreRefused) {
    folder.write("reactions.csv", "probe,time,tool,fx,fy,fz\n1,0,ball,,,-0.5\n");
    EXPECT_TRUE(says(message_of<InvalidInput>([&] { read(); }),
                     {"motions.csv", "'grip' moves in 1 state", "nothing was read", "displacements.csv"}));
    folder.write("displacements.csv", displacements + "2,1,7,1,0,0,\n");
    EXPECT_NO_THROW(read());
}

TEST_F(RigFiles, WithMotionAndForceOfOneContactAreRefused) {
    const std::string header = "probe,time,x,y,z,fx,fy,fz,radius\n";
    EXPECT_TRUE(says(refusal("probes.csv", header + "1,0,62,10,20,0,0,-1,2\n"),
                     {"probes.csv", "probe 1 at time 0", "[62, 10, 20] mm", "tool 'ball'", "reactions.csv"}));
    EXPECT_TRUE(says(refusal("probes.csv", header + "2,1,100,10,10,0,0,-1,2\n"), {"probe 2 at time 1", "tool 'grip'"}));
    EXPECT_EQ(refusal("probes.csv", header + "1,0,30,10,20,0,0,-1,2\n"), "");  // elsewhere
    EXPECT_EQ(refusal("probes.csv", header + "3,0,62,10,20,0,0,-1,2\n"), "");  // the ball is away
    // the ball at rest is 1 mm off the surface
    folder.write("motions.csv", "probe,time,tool,x,y,z\n1,0,ball,0,0,0\n2,1,grip,1,0,0\n");
    EXPECT_EQ(refusal("probes.csv", header + "1,0,60,10,20,0,0,-1,2\n"), "");
}

TEST_F(RigFiles, WithForcesUnderPunchesAreRefused) {
    folder.write("set.yaml", with("sphere: {radius: 5}}, at: [60, 10, 26]",
                                  "flat: {radius: 5}}, at: [60, 10, 25], axis: [0, 0, -1]"));
    folder.write("motions.csv", "probe,time,tool,x,y,z\n1,0,ball,0,0,-6\n2,1,grip,1,0,0\n");
    const std::string header = "probe,time,x,y,z,fx,fy,fz,radius\n";
    EXPECT_TRUE(says(refusal("probes.csv", header + "1,0,63,10,20,0,0,-1,2\n"), {"tool 'ball'"}));
    EXPECT_EQ(refusal("probes.csv", header + "1,0,66,10,20,0,0,-1,2\n"), "");

    // a bar along y that is turned about its centre comes to lie over x = 65
    mesh::write_surface(folder / "punch.stl", mesh::make_box({59, 4, 21}, {61, 16, 25}, {1, 1, 1}));
    folder.write("set.yaml", with("sphere: {radius: 5}}, at: [60, 10, 26]", "mesh: punch.stl}"));
    folder.write("motions.csv", "probe,time,tool,x,y,z,rz\n1,0,ball,0,0,-2,0\n2,1,grip,1,0,0,0\n");
    EXPECT_EQ(refusal("probes.csv", header + "1,0,65,10,20,0,0,-1,2\n"), "");
    folder.write("motions.csv", "probe,time,tool,x,y,z,rz\n1,0,ball,0,0,-2,90\n2,1,grip,1,0,0,0\n");
    EXPECT_TRUE(says(refusal("probes.csv", header + "1,0,65,10,20,0,0,-1,2\n"), {"tool 'ball'"}));
}

TEST_F(RigFiles, ThatGripWhatIsHeldAreRefused) {
    EXPECT_TRUE(says(refusal_of_yaml("min: [89,", "min: [-1,"), {"gripped by tool 'grip'", "support", "apart"}));
    folder.write("set.yaml", with("actuators:",
                                  "  - {name: other, region: {box: {min: [80, 0, 0], max: [90, 20, 20]}}}\n"
                                  "actuators:"));
    EXPECT_TRUE(says(refusal("motions.csv", motions + "2,1,other,1,0,0,0,0,0\n"),
                     {"'grip' and 'other'", "probe 2 at time 1", "apart"}));
}

TEST_F(RigFiles, WithDisplacementsSinceNoStateAreRefused) {
    EXPECT_TRUE(says(refusal("set.yaml", yaml + "displacements: {since: {probe: 9, time: 0}}\n"),
                     {"displacements.csv", "probe 9 at time 0", "displacements.since", "no such state"}));
    EXPECT_TRUE(says(refusal("set.yaml", yaml + "displacements: {since: {probe: 1, time: 0}}\n"),
                     {"displacements.csv, line 2", "marker 7", "since this very state"}));
    fs::remove(folder / "displacements.csv");
    folder.write("set.yaml", yaml + "displacements: {since: {probe: 1, time: 0}}\n");
    EXPECT_TRUE(says(message_of<IoError>([&] { read(); }), {"displacements.csv", "no such file"}));
}

// What a user can get wrong about actuators.

TEST_F(RigFiles, WithActuatorsThatAreNoneAreRefused) {
    EXPECT_TRUE(says(refusal_of_yaml("kind: pressure", "kind: motor"), {"'motor'", "'pressure', 'tendon'"}));
    EXPECT_TRUE(says(refusal_of_yaml("{near: [30, 10, 6]}", "{}"), {"cavity", "neither stands"}));
    EXPECT_TRUE(says(refusal_of_yaml("by: tension", "by: force"), {"'force'", "'tension', 'length'"}));
    EXPECT_TRUE(says(refusal_of_yaml("[[0, 10, 15], [50, 10, 15], [80, 10, 12]]", "[[0, 10, 15]]"),
                     {"1 point", "two at least"}));
    EXPECT_TRUE(says(refusal_of_yaml("[50, 10, 15]", "[0, 10, 15]"), {"points 1 and 2 are the same"}));
}

TEST_F(RigFiles, WithoutACavityNearThePointAreRefused) {
    EXPECT_TRUE(says(refusal_of_yaml("near: [30, 10, 6]", "near: [60, 10, 6]"),
                     {"actuator 'chamber'", "20 mm from [60, 10, 6] mm", "5 mm are allowed"}));
    mesh::write_surface(folder / "rest.vtp", bar());
    EXPECT_TRUE(
        says(message_of<InvalidInput>([&] { read(); }),
             {"actuator 'chamber'", "no closed cavity near [30, 10, 6] mm", "no shell inside", "surface: FILE"}));

    // a dent in the top: a hollow, and open
    mesh::Surface dented = bar();
    for (auto p : dented.vertices.rowwise())
        if (p.z() == 20 && p.x() > 25 && p.x() < 45 && p.y() == 10) p.z() = 5;
    mesh::write_surface(folder / "rest.vtp", dented);
    EXPECT_TRUE(says(refusal_of_yaml("near: [30, 10, 6]", "near: [30, 10, 12]"), {"open to the outside"}));

    mesh::Surface open = chamber();
    open.triangles.conservativeResize(open.triangles.rows() - 1, 3);
    mesh::write_surface(folder / "rest.vtp", with_hollow(bar(), open));
    EXPECT_TRUE(says(message_of<InvalidInput>([&] { read(); }),
                     {"actuator 'chamber'", "nearest to [30, 10, 6] mm is open", "3 of its edges"}));
}

TEST_F(RigFiles, WithTwoPressuresInOneCavityAreRefused) {
    EXPECT_TRUE(says(
        refusal_of_yaml("actuators:\n", "actuators:\n  - {name: left, kind: pressure, cavity: {near: [22, 8, 4]}}\n"),
        {"'left' and 'chamber'", "same cavity", "960 mm^3"}));
    EXPECT_TRUE(says(refusal("states.csv", "probe,time,pressure\n3,0,1\n"),
                     {"states.csv", "probe 3 at time 0", "'chamber'", "empty"}));
}

TEST_F(RigFiles, WithChambersOffTheBodyAreRefused) {
    mesh::Surface chamber = mesh::make_box({20, 60, 3}, {40, 140, 9}, {2, 2, 2});
    mesh::write_surface(folder / "chamber.stl", chamber);
    EXPECT_TRUE(says(refusal_of_yaml("near: [30, 10, 6]", "surface: chamber.stl"),
                     {"chamber of actuator 'chamber'", "[20, 60, 3]", "out of the body", "unit"}));
    mesh::write_surface(folder / "chamber.stl", mesh::make_box({50, 6, 12}, {70, 14, 22}, {1, 1, 1}));
    EXPECT_TRUE(says(refusal_of_yaml("near: [30, 10, 6]", "surface: chamber.stl"),
                     {"chamber of actuator 'chamber'", "cannot be carved out", "22] mm", "2 mm outside"}));
    chamber.triangles.conservativeResize(chamber.triangles.rows() - 1, 3);
    mesh::write_surface(folder / "chamber.stl", chamber);
    EXPECT_TRUE(says(refusal_of_yaml("near: [30, 10, 6]", "surface: chamber.stl"), {"'chamber.stl' is not closed"}));
}

TEST_F(RigFiles, WithTendonsOutsideOfTheBodyAreRefused) {
    EXPECT_TRUE(says(refusal_of_yaml("[50, 10, 15]", "[50, 10, 25]"),
                     {"point 2 of tendon 'cable'", "[50, 10, 25] mm", "5 mm outside", "1 mm"}));
    EXPECT_EQ(refusal_of_yaml("[0, 10, 15]", "[-0.9, 10, 15]"), "");  // where it enters
}

}  // namespace
}  // namespace palpate::identify
