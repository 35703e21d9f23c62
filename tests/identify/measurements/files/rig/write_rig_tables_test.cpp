#include <cmath>
#include <string>

#include "tests/identify/rig_files.h"

namespace palpate::identify {
namespace {

// A set of the second format says the same once it is written and read.

bool same_number(double a, double b) { return a == b || (std::isnan(a) && std::isnan(b)); }
bool same_vector(const Vec3& a, const Vec3& b) {
    return same_number(a[0], b[0]) && same_number(a[1], b[1]) && same_number(a[2], b[2]);
}

void expect_same_rig(const LoadState& a, const LoadState& b) {
    ASSERT_EQ(a.motions.size(), b.motions.size());
    for (std::size_t i = 0; i < a.motions.size(); ++i) {
        EXPECT_EQ(a.motions[i].tool, b.motions[i].tool);
        EXPECT_TRUE(same_vector(a.motions[i].translation, b.motions[i].translation));
        EXPECT_TRUE(same_vector(a.motions[i].rotation, b.motions[i].rotation));
    }
    ASSERT_EQ(a.reactions.size(), b.reactions.size());
    for (std::size_t i = 0; i < a.reactions.size(); ++i) {
        EXPECT_EQ(a.reactions[i].tool, b.reactions[i].tool);
        EXPECT_TRUE(same_vector(a.reactions[i].force, b.reactions[i].force));
        EXPECT_TRUE(same_vector(a.reactions[i].moment, b.reactions[i].moment));
        EXPECT_TRUE(same_number(a.reactions[i].sigma, b.reactions[i].sigma));
    }
    ASSERT_EQ(a.actuations.size(), b.actuations.size());
    for (std::size_t i = 0; i < a.actuations.size(); ++i) {
        EXPECT_EQ(a.actuations[i].actuator, b.actuations[i].actuator);
        EXPECT_EQ(a.actuations[i].value, b.actuations[i].value);
        EXPECT_TRUE(same_number(a.actuations[i].sigma, b.actuations[i].sigma));
    }
    ASSERT_EQ(a.readings.size(), b.readings.size());
    for (std::size_t i = 0; i < a.readings.size(); ++i) {
        EXPECT_EQ(a.readings[i].since, b.readings[i].since);
        EXPECT_TRUE(same_vector(a.readings[i].position, b.readings[i].position));
    }
}

TEST_F(RigFiles, AreReadBackEqual) {
    mesh::write_surface(folder / "punch.stl", mesh::make_box({58, 8, -9}, {66, 12, -1}, {1, 1, 1}));
    mesh::write_surface(folder / "chamber.stl", mesh::make_box({50, 6, 12}, {70, 14, 18}, {2, 2, 2}));
    std::string many = "x,y,z\n";
    for (int i = 0; i < 30; ++i) many += "95," + std::to_string(i % 20) + ",20\n";
    folder.write("glued.csv", many);
    std::string text = with("actuators:\n",
                            "  - {name: punch, shape: {flat: {radius: 3}}, at: [70, 10, 20], contact: bonded}\n"
                            "  - {name: die, shape: {mesh: punch.stl}, origin: [60, 10, -3], contact: frictionless}\n"
                            "  - name: pads\n"
                            "    region:\n"
                            "      - points: {file: glued.csv, within: 0.5}\n"
                            "      - sphere: {center: [85, 10, 0], radius: 2.5}\n"
                            "actuators:\n"
                            "  - {name: \"a tube\", kind: pressure, cavity: {surface: chamber.stl}}\n"
                            "  - {name: 2, kind: tendon, path: [[0, 10, 5], [80, 10, 5.1]], by: length}\n");
    folder.write("set.yaml", text + "correlated: {position: 3}\ndisplacements: {since: {probe: 2, time: 0}}\n");
    folder.write("motions.csv", motions + "4,0,punch,0,0,-0.3,0,0,0\n4,0,die,0.1,0,,0,,0\n4,0,pads,0,0,0.7,0,0,0\n");
    folder.write("reactions.csv", reactions + "4,0,die,,,1,,,,\n4,0,pads,0.1,0.2,0.3,1,2,3,0.7\n");
    folder.write("actuations.csv", actuations + "4,0,a tube,7,0.1\n4,0,2,-0.3,\n");
    const MeasurementSet set = read();
    ASSERT_EQ(set.tools.size(), 5U);
    write_measurement_set(folder / "copy", set);
    const MeasurementSet copy = read_measurement_set(folder / "copy");

    EXPECT_EQ(copy.reaction_noise, set.reaction_noise);
    EXPECT_EQ(copy.moment_noise, set.moment_noise);
    EXPECT_EQ(copy.position_correlation, set.position_correlation);
    ASSERT_EQ(copy.tools.size(), set.tools.size());
    for (std::size_t t = 0; t < set.tools.size(); ++t) {
        EXPECT_EQ(copy.tools[t].name, set.tools[t].name);
        EXPECT_EQ(copy.tools[t].bonded, set.tools[t].bonded);
        EXPECT_EQ(copy.tools[t].origin, set.tools[t].origin);
        EXPECT_EQ(copy.tools[t].shape.index(), set.tools[t].shape.index());
    }
    EXPECT_EQ(std::get<mesh::FlatShape>(copy.tools[2].shape).axis, std::get<mesh::FlatShape>(set.tools[2].shape).axis);
    EXPECT_EQ(std::get<mesh::SurfaceShape>(copy.tools[3].shape).surface.vertices,
              std::get<mesh::SurfaceShape>(set.tools[3].shape).surface.vertices);
    const auto& pads = std::get<mesh::GripShape>(copy.tools[4].shape).regions;
    ASSERT_EQ(pads.size(), 2U);
    EXPECT_EQ(std::get<mesh::PointsRegion>(pads[0]).points.rows(), 30);

    ASSERT_EQ(copy.actuators.size(), 4U);
    EXPECT_EQ(std::get<mesh::Surface>(std::get<mesh::PressureActuator>(copy.actuators[0].kind).cavity).vertices,
              std::get<mesh::Surface>(std::get<mesh::PressureActuator>(set.actuators[0].kind).cavity).vertices);
    EXPECT_EQ(copy.actuators[1].name, "2");
    EXPECT_TRUE(std::get<mesh::TendonActuator>(copy.actuators[1].kind).by_length);
    EXPECT_EQ(std::get<mesh::TendonActuator>(copy.actuators[3].kind).path,
              std::get<mesh::TendonActuator>(set.actuators[3].kind).path);

    ASSERT_EQ(copy.states.size(), set.states.size());
    for (std::size_t s = 0; s < set.states.size(); ++s) {
        EXPECT_EQ(copy.states[s].probe, set.states[s].probe);
        EXPECT_EQ(copy.states[s].time, set.states[s].time);
        expect_same_rig(copy.states[s], set.states[s]);
    }
    EXPECT_EQ(copy.states[0].readings[0].since, (StateName{2, 0}));
}

TEST_F(RigFiles, WithoutNewPartsAreWrittenInTheFirstFormat) {
    MeasurementSet set = read();
    set.tools.clear();
    set.actuators.clear();
    set.reaction_noise.reset();
    set.moment_noise.reset();
    for (LoadState& state : set.states) {
        state.motions.clear();
        state.actuations.clear();
        state.reactions.clear();
    }
    write_measurement_set(folder / "copy", set);
    EXPECT_NE(text_of("copy/set.yaml").find("palpate-measurements/1"), std::string::npos);
    EXPECT_EQ(read_measurement_set(folder / "copy").states.size(), 4U);
}

}  // namespace
}  // namespace palpate::identify
