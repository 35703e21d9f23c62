// Bodies as people have them, through the commands: ready-made meshes, labels, places of faults, other programs' files.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "mesh/errors.h"
#include "mesh/formats/read_body.h"
#include "mesh/formats/surface/read_surface.h"
#include "mesh/formats/volume/write_volume.h"
#include "mesh/formats/vtk/vtk_files.h"
#include "mesh/text/atomic_file.h"
#include "pipeline/case/settings/read_case.h"
#include "pipeline/case/subject/subject.h"
#include "pipeline/command_line/commands.h"
#include "tests/messages.h"
#include "tests/temporary_folder.h"

namespace palpate::pipeline {
namespace {

using ::testing::HasSubstr;

/// A bar of 60 x 20 x 20 mm in linear tetrahedra.
mesh::VolumeMesh coarse_bar() { return mesh::make_bar({0, 0, 0}, {60, 20, 20}, {6, 2, 2}); }

CaseOverrides in_cm() {
    CaseOverrides overrides;
    overrides.set("unit", "cm");
    return overrides;
}

CaseOverrides of_label(int label, CaseOverrides overrides = {}) {
    overrides.set("label", label);
    return overrides;
}

/// An image of 20 x 10 x 10 voxels of 2 mm, labelled 1 and 2 in its halves.
std::string two_labels() {
    std::string voxels(20 * 10 * 10, '\0');
    for (std::size_t v = 0; v < voxels.size(); ++v) {
        const std::size_t x = v % 20, y = v / 20 % 10, z = v / 200;
        if (x > 0 && x < 19 && y > 0 && y < 9 && z > 0 && z < 9) voxels[v] = x < 8 ? 1 : 2;
    }
    return "NDims = 3\nDimSize = 20 10 10\nElementSpacing = 2 2 2\nElementType = MET_UCHAR\nElementDataFile = LOCAL\n" +
           voxels;
}

TEST(BodyFiles, AReadyMadeMeshIsUsedAsItIs) {
    const TemporaryFolder scratch;
    const mesh::VolumeMesh bar = coarse_bar();
    mesh::write_gmsh(scratch / "bar.msh", bar, mesh::GmshVersion::v4_1);
    const auto outcome =
        commands::mesh_body({.input = scratch / "bar.msh", .output = scratch / "body.vtu", .overrides = {}}, {});
    const mesh::VolumeMesh body = mesh::read_vtu(scratch / "body.vtu");
    EXPECT_EQ(body.tetrahedra.rows(), bar.tetrahedra.rows());
    EXPECT_TRUE(body.is_quadratic());
    EXPECT_THAT(outcome.json["repair"].dump(), HasSubstr("used as it is"));
    CaseOverrides linear;
    linear.set("volume.linear_elements", "true");
    commands::mesh_body({.input = scratch / "bar.msh", .output = scratch / "linear.vtu", .overrides = linear}, {});
    EXPECT_FALSE(mesh::read_vtu(scratch / "linear.vtu").is_quadratic());
}

TEST(BodyFiles, AReadyMadeMeshIsScaled) {
    const TemporaryFolder scratch;
    mesh::write_gmsh(scratch / "bar.msh", coarse_bar(), mesh::GmshVersion::v2_2);
    const Subject subject = read_subject(read_case(scratch / "bar.msh", in_cm()));
    EXPECT_NEAR(mesh::element_volumes(*subject.volume).sum(), 24e6, 1e-3);  // rounding of 144 sums
    EXPECT_NEAR(mesh::bounding_box(subject.surface.vertices).longest_side(), 600, 1e-9);
}

TEST(BodyFiles, ABoundaryThatMeetsItselfIsRefused) {
    // two bars with one edge in common
    const TemporaryFolder scratch;
    mesh::VolumeMesh a = mesh::make_bar({0, 0, 0}, {1, 1, 1}, {1, 1, 1});
    const mesh::VolumeMesh b = mesh::make_bar({1, 1, 0}, {2, 2, 1}, {1, 1, 1});
    mesh::VolumeMesh both{Points(16, 3), Tetrahedra(12, 4), {}};
    both.nodes << a.nodes, b.nodes;
    both.tetrahedra << a.tetrahedra, (b.tetrahedra.array() + 8).matrix();
    both.faces = mesh::boundary_faces(both.tetrahedra);
    mesh::write_gmsh(scratch / "both.msh", both, mesh::GmshVersion::v2_2);
    EXPECT_TRUE(says(message_of<InvalidInput>([&] {
                         commands::mesh_body(
                             {.input = scratch / "both.msh", .output = scratch / "b.vtu", .overrides = {}}, {});
                     }),
                     {"1 edges", "palpate check"}));
}

TEST(BodyFiles, ALabelIsChosenInACaseOrByAFlag) {
    const TemporaryFolder scratch;
    scratch.write("organs.mha", two_labels());
    EXPECT_TRUE(says(message_of<InvalidInput>([&] { read_subject(read_case(scratch / "organs.mha")); }),
                     {"2 labels", "--label"}));
    // Voxels 8 to 18 of 2 mm; a box loses its edges to the smoothing and bulges for it, by less than a voxel.
    const Subject flag = read_subject(read_case(scratch / "organs.mha", of_label(2)));
    EXPECT_NEAR(mesh::bounding_box(flag.surface.vertices).extent().x(), 22, 2);
    EXPECT_TRUE(flag.settings.name == "organs");
    const auto written = scratch.write("case.yaml", "format: palpate-case/1\nmesh: organs.mha\nlabel: 1\n");
    const Subject said = read_subject(read_case(written));
    EXPECT_NEAR(mesh::bounding_box(said.surface.vertices).extent().x(), 14, 2);
    EXPECT_THAT(to_yaml(said.settings), HasSubstr("label: 1"));
    EXPECT_TRUE(
        says(message_of<InvalidInput>([&] { read_subject(read_case(scratch / "organs.mha", of_label(2, in_cm()))); }),
             {"organs.mha", "states its unit itself", "--longest"}));
}

TEST(BodyFiles, CheckShowsWhereFaultsAre) {
    const TemporaryFolder scratch;
    mesh::Surface box = mesh::make_box({0, 0, 0}, {10, 10, 10}, {2, 2, 2});
    box.triangles.conservativeResize(box.triangles.rows() - 1, 3);
    mesh::write_surface(scratch / "open.obj", box);
    const auto outcome =
        commands::check({.input = scratch / "open.obj", .output = scratch / "report", .overrides = {}}, {});
    EXPECT_THAT(outcome.text, HasSubstr("open edge of a hole: at ("));
    EXPECT_EQ(outcome.json["places"].size(), 3u);
    EXPECT_EQ(outcome.json["places"][0]["fault"], "open edge of a hole");
    EXPECT_THAT(mesh::read_text(scratch / "report/faults.vtp"), HasSubstr("\"fault\""));
    EXPECT_EQ(mesh::read_surface(scratch / "report/surface.vtp").triangles.rows(), box.triangles.rows());
    // A second time: what palpate made may be replaced, what it did not make may not.
    EXPECT_NO_THROW(
        commands::check({.input = scratch / "open.obj", .output = scratch / "report", .overrides = {}}, {}));
    scratch.write("own/notes.txt", "x");
    EXPECT_TRUE(says(message_of<InvalidInput>([&] {
                         commands::check({.input = scratch / "open.obj", .output = scratch / "own", .overrides = {}},
                                         {});
                     }),
                     {"own", "not made by palpate"}));
}

TEST(BodyFiles, AMeshIsWrittenForOtherPrograms) {
    const TemporaryFolder scratch;
    mesh::write_gmsh(scratch / "bar.msh", coarse_bar(), mesh::GmshVersion::v2_2);
    for (const auto& [name, format] : {std::pair("a.inp", ""), std::pair("b.msh", ""), std::pair("c.txt", "msh22")}) {
        commands::mesh_body({.input = scratch / "bar.msh", .output = scratch / name, .format = format, .overrides = {}},
                            {});
        EXPECT_THAT(mesh::read_text(scratch / name), HasSubstr("made by palpate")) << name;
    }
    EXPECT_THAT(mesh::read_text(scratch / "a.inp"), HasSubstr("*NSET, NSET=NHELD"));
    EXPECT_THAT(mesh::read_text(scratch / "c.txt"), HasSubstr("$MeshFormat\n2.2"));
    EXPECT_EQ(mesh::read_body(scratch / "b.msh").volume->tetrahedra.cols(), 10);
    EXPECT_TRUE(says(message_of<InvalidInput>([&] {
                         commands::mesh_body(
                             {.input = scratch / "bar.msh", .output = scratch / "d.doc", .overrides = {}}, {});
                     }),
                     {"d.doc", ".inp", "--to"}));
}

}  // namespace
}  // namespace palpate::pipeline
