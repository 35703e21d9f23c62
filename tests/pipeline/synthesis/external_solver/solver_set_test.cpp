// `palpate probe --from` and `--to`: another solver's fields become a measurement set, and ours become its input.

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>

#include "fem/elastic_body.h"
#include "fem/elements/patch_load.h"
#include "identify/measurements/field.h"
#include "mesh/errors.h"
#include "mesh/formats/volume/write_volume.h"
#include "mesh/formats/vtk/vtk_files.h"
#include "mesh/text/atomic_file.h"
#include "pipeline/command_line/commands.h"
#include "pipeline/synthesis/external_solver/nodal_loads.h"
#include "tests/messages.h"
#include "tests/temporary_folder.h"

namespace palpate::pipeline {
namespace {

namespace fs = std::filesystem;
using identify::MeasurementSet;

/// A bar of 40 x 10 x 10 mm that somebody else meshed and computed: x = 0 stays, u = x^2 (0, 0, s) / 1600 elsewhere.
struct Foreign : ::testing::Test {
    static Points field(const Points& nodes, double s) {
        Points u = Points::Zero(nodes.rows(), 3);
        u.col(2) = s / 1600 * nodes.col(0).cwiseAbs2();
        return u;
    }
    void write_field(const std::string& name, double s, double unit = 1) const {
        mesh::VolumeMesh scaled = bar;
        scaled.nodes /= unit;
        mesh::write_vtu(results() / name, scaled, {.points = {{"displacement", field(bar.nodes, s) / unit}}});
    }
    void write_probes(const std::string& rows) const {
        mesh::write_text(results() / "probes.csv", "probe,time,x,y,z,fx,fy,fz,radius\n" + rows);
    }
    fs::path results() const { return folder / "results"; }

    commands::ProbeCommandOptions options() const {
        mesh::write_vtu(folder / "bar.vtu", bar);
        commands::ProbeCommandOptions options{.input = folder / "bar.vtu", .output = folder / "set", .overrides = {}};
        options.from = results();
        return options;
    }
    MeasurementSet take(commands::ProbeCommandOptions how) const {
        commands::probe(how, {.json = false, .force = true, .threads = 1, .seed = {}});
        return identify::read_measurement_set(how.output);
    }
    MeasurementSet take() const { return take(options()); }
    std::string refusal() const {
        return message_of<InvalidInput>([&] { take(); });
    }

    mesh::VolumeMesh bar = mesh::make_bar({0, 0, 0}, {40, 10, 10}, {8, 2, 2});
    TemporaryFolder folder;
};

TEST_F(Foreign, ReadingsAreTheSolversOwnNumbers) {
    write_probes("1,1,40,5,10,0,0,1,2\n2,1,40,5,10,0,0,-1,2\n");
    write_field("1_1.vtu", 2);
    write_field("2_1.vtu", -3);
    const MeasurementSet set = take();
    ASSERT_EQ(set.states.size(), 2U);
    EXPECT_GE(set.markers.size(), 20U);
    const std::array<double, 2> shares{2, -3};
    for (std::size_t s = 0; s < 2; ++s)
        for (const identify::Reading& reading : set.states[s].readings) {
            const Vec3 rest = set.markers[static_cast<std::size_t>(reading.marker)].rest;
            EXPECT_NEAR(reading.position.z() - rest.z(), shares[s] * rest.x() * rest.x() / 1600, 1e-12);
            EXPECT_GT(rest.x(), 0) << "a marker on what is held";
        }
    // It is held where nothing moves, and the whole field is there.
    EXPECT_TRUE(mesh::contains(set.supports, Vec3(0, 5, 5)));
    EXPECT_FALSE(mesh::contains(set.supports, Vec3(5, 5, 5)));
    const identify::Field whole = identify::read_field(set.states[1]);
    EXPECT_TRUE(whole.displacement.isApprox(field(whole.mesh.nodes, -3), 1e-9));
}

TEST_F(Foreign, FilesWithoutProbeInTheirNameCountAsPeopleCount) {
    std::string rows;
    for (int k = 1; k <= 11; ++k) {
        rows += std::to_string(k) + ",1,40,5,10,0,0,1,2\n";
        write_field("step" + std::to_string(k) + ".vtu", k);
    }
    write_probes(rows);
    const MeasurementSet set = take();
    for (int k = 1; k <= 11; ++k) {
        const identify::Reading& reading = set.states[static_cast<std::size_t>(k - 1)].readings.front();
        const Vec3 rest = set.markers[static_cast<std::size_t>(reading.marker)].rest;
        EXPECT_NEAR(reading.position.z() - rest.z(), k * rest.x() * rest.x() / 1600, 1e-12) << k;
    }
}

TEST_F(Foreign, StatesThatNobodyComputedForWantOfALoadAreLeftOut) {
    write_probes("0,0,0,0,0,0,0,0,0\n1,1,40,5,10,0,0,1,2\n");
    write_field("a.vtu", 1);
    const MeasurementSet set = take();
    ASSERT_EQ(set.states.size(), 1U);
    EXPECT_EQ(set.states.front().probe, 1);
}

TEST_F(Foreign, LengthsAreInTheUnitOfTheMesh) {
    write_probes("1,1,4,0.5,1,0,0,1,0.2\n");
    write_field("1_1.vtu", 2, 10);
    mesh::VolumeMesh in_cm = bar;
    in_cm.nodes /= 10;
    commands::ProbeCommandOptions how = options();
    how.input = folder / "cm.vtu";
    mesh::write_vtu(how.input, in_cm);
    how.overrides.set("unit", "cm");
    const MeasurementSet set = take(how);
    EXPECT_NEAR(mesh::bounding_box(set.rest_surface.vertices).longest_side(), 40, 1e-9);
    EXPECT_NEAR(set.states.front().contacts.front().radius, 2, 1e-12);
    const identify::Reading& reading = set.states.front().readings.front();
    const Vec3 rest = set.markers[static_cast<std::size_t>(reading.marker)].rest;
    EXPECT_NEAR(reading.position.z() - rest.z(), 2 * rest.x() * rest.x() / 1600, 1e-9);
}

TEST_F(Foreign, ADeckTellsWhatIsHeldWhateverTheOrderOfItsNodes) {
    write_probes("1,1,40,5,10,0,0,1,2\n");
    write_field("1_1.vtu", 2);
    std::string deck = "*NODE\n";  // backwards; held at the far end, which the field moves
    std::string held = "*BOUNDARY\n";
    for (Eigen::Index n = bar.nodes.rows(); n-- > 0;) {
        deck += fmt::format("{}, {}, {}, {}\n", n + 1, bar.nodes(n, 0), bar.nodes(n, 1), bar.nodes(n, 2));
        if (bar.nodes(n, 0) == 40) held += fmt::format("{}, 1, 3\n", n + 1);
    }
    mesh::write_text(results() / "job.inp", deck + held);
    const MeasurementSet set = take();
    EXPECT_TRUE(mesh::contains(set.supports, Vec3(40, 5, 5)));
    EXPECT_FALSE(mesh::contains(set.supports, Vec3(0, 5, 5)));
}

TEST_F(Foreign, SlipsAreNamed) {
    write_probes("1,1,40,5,10,0,0,1,2\n2,1,40,5,10,0,0,1,2\n");
    write_field("a.vtu", 2);
    EXPECT_TRUE(says(refusal(), {"1 fields for 2 states", "probes.csv", "<probe>_<time>"}));
    write_field("b.vtu", 2);
    fs::rename(results() / "probes.csv", folder / "probes.csv");
    EXPECT_TRUE(says(refusal(), {"nothing specifies the loads", "probes.csv", "*CLOAD"}));
    fs::rename(folder / "probes.csv", results() / "probes.csv");

    write_field("a.vtu", 2, 1000);
    EXPECT_TRUE(says(refusal(), {"a.vtu", "apart", "0.001 times as large", "--unit"}));
    mesh::VolumeMesh warped = bar;
    warped.nodes += field(bar.nodes, 5);
    mesh::write_vtu(results() / "a.vtu", warped, {.points = {{"displacement", field(bar.nodes, 5)}}});
    EXPECT_TRUE(says(refusal(), {"a.vtu", "not warped"}));
    mesh::write_text(results() / "x.frd", "");
    EXPECT_TRUE(says(refusal(), {"several kinds", ".frd", ".vtu"}));
    fs::remove_all(results());
    EXPECT_TRUE(says(message_of<IoError>([&] { take(); }), {"no such folder"}));
}

TEST(NodalLoads, APatchIsTheDiscThatSpreadsAsFar) {
    // An even pressure on a disc of radius 3 on the top of a fine plate, as nodal forces; and one node at the side.
    const TemporaryFolder folder;
    const mesh::VolumeMesh plate = mesh::make_bar({0, 0, 0}, {20, 20, 4}, {40, 40, 2});
    Eigen::VectorXd forces = Eigen::VectorXd::Zero(3 * plate.nodes.rows());
    int pressed = 0;
    Eigen::Index side = -1;
    for (Eigen::Index n = 0; n < plate.nodes.rows(); ++n) {
        const Vec3 x = plate.nodes.row(n);
        if (x.z() == 4 && (x - Vec3(10, 8, 4)).norm() <= 3) {
            forces[3 * n + 2] = -0.01;
            ++pressed;
        }
        if (x == Vec3(20, 10, 2)) side = n;
    }
    forces[3 * side] = 0.5;
    mesh::write_inp(folder / "plate.inp", plate,
                    {.held = std::vector<char>(static_cast<std::size_t>(plate.nodes.rows()), 0),
                     .material = {1, 0.3, 1e-9},
                     .steps = {forces}});
    std::vector<std::string> notes;
    const auto states = states_of_steps(mesh::read_deck(folder / "plate.inp"), 1, notes);
    ASSERT_EQ(states.size(), 1U);
    ASSERT_EQ(states.front().contacts.size(), 2U);
    const bool first_is_disc = states.front().contacts[0].radius > 0;
    const mesh::Contact& disc = states.front().contacts[first_is_disc ? 0 : 1];
    const mesh::Contact& node = states.front().contacts[first_is_disc ? 1 : 0];
    EXPECT_NEAR(disc.force.z(), -0.01 * pressed, 1e-9);
    EXPECT_NEAR((disc.point - Vec3(10, 8, 4)).norm(), 0, 1e-6);
    EXPECT_NEAR(disc.radius, 3, 0.15);  // nodes 0.5 apart
    EXPECT_EQ(node.radius, 0);
    EXPECT_NEAR((node.point - Vec3(20, 10, 2)).norm(), 0, 1e-9);
    EXPECT_NEAR(node.force.x(), 0.5, 1e-12);
    EXPECT_TRUE(notes.empty()) << notes.front();
}

TEST(NodalLoads, WhatIsHeldIsABoxWhereItFillsOne) {
    Points held(4, 3), others(2, 3);
    held << 0, 0, 0, 0, 10, 0, 0, 0, 10, 0, 10, 10;
    others << 1e-4, 5, 5, 5, 5, 5;
    const mesh::Region box = held_region(held, others, 2);
    ASSERT_TRUE(std::holds_alternative<mesh::BoxRegion>(box));
    EXPECT_TRUE(mesh::contains(box, Vec3(0, 5, 5)));
    EXPECT_FALSE(mesh::contains(box, Vec3(1e-4, 5, 5)));
    others.row(0) << 0, 5, 5;  // a node that is free between those that are held
    EXPECT_TRUE(std::holds_alternative<mesh::PointsRegion>(held_region(held, others, 2)));
}

/// CalculiX computes what we planned: the same equations, so the same numbers, to the digits that it prints.
TEST(OwnSolver, CalculixMakesTheSetThatOurElementsMake) {
    if (std::system("command -v ccx > /dev/null 2>&1") != 0) GTEST_SKIP() << "CalculiX is not installed";
    const TemporaryFolder folder;
    mesh::write_vtu(folder / "bar.vtu", mesh::make_bar({0, 0, 0}, {60, 20, 20}, {6, 2, 2}));
    commands::ProbeCommandOptions how{.input = folder / "bar.vtu", .output = folder / "deck", .overrides = {}};
    how.overrides.set("probing.probes", 3);
    how.overrides.set("material.poisson", 0.4);
    how.synthesis.law = fem::MaterialLaw::linear;
    how.to = "inp";
    commands::probe(how, {});
    ASSERT_EQ(std::system(("cd '" + (folder / "deck").string() + "' && ccx body > ccx.log 2>&1").c_str()), 0);
    how.to.clear();
    how.from = folder / "deck";
    how.output = folder / "set";
    commands::probe(how, {});

    const MeasurementSet set = identify::read_measurement_set(folder / "set");
    ASSERT_EQ(set.states.size(), 4U);
    for (const identify::LoadState& state : set.states) {
        const identify::Field field = identify::read_field(state);
        const fem::ElasticBody body(field.mesh, {.young = 0.1, .poisson = 0.4, .density = 1e-9},
                                    mesh::contains(set.supports, field.mesh.nodes));
        const Eigen::VectorXd loads =
            fem::patch_loads(field.mesh, state.contacts, 1) * Eigen::VectorXd::Ones(std::ssize(state.contacts));
        const Eigen::MatrixXd solved = body.solve(Eigen::MatrixXd(loads));
        const Eigen::Map<const Points> u(solved.data(), solved.rows() / 3, 3);
        EXPECT_LE((u - field.displacement).norm(), 2e-5 * u.norm()) << state.probe;  // six digits, of nodes too
    }
}

}  // namespace
}  // namespace palpate::pipeline
