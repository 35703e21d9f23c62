// Ready-made volume meshes: what other programs write is read as it is, or refused with the element named.

#include <gtest/gtest.h>

#include <cstring>
#include <numeric>

#include "mesh/errors.h"
#include "mesh/formats/read_body.h"
#include "mesh/formats/volume/write_volume.h"
#include "mesh/formats/vtk/vtk_files.h"
#include "tests/messages.h"
#include "tests/temporary_folder.h"

namespace palpate::mesh {
namespace {

struct ReadVolume : ::testing::Test {
    BodyFile read(const std::string& name, const std::string& text) { return read_body(folder.write(name, text)); }
    std::string refusal(const std::string& name, const std::string& text) {
        return message_of<InvalidInput>([&] { read(name, text); });
    }
    TemporaryFolder folder;
};

/// One tetrahedron with the corners 0, x, y, z of length 2, volume 4/3.
const std::array<Vec3, 4> corners{{{0, 0, 0}, {2, 0, 0}, {0, 2, 0}, {0, 0, 2}}};
constexpr double corner_volume = 4.0 / 3;

std::string joined_lines(std::initializer_list<std::string> lines) {
    return std::accumulate(lines.begin(), lines.end(), std::string(),
                           [](std::string all, const std::string& line) { return std::move(all) + line + "\n"; });
}

/// The midside between two corners.
std::string middle(int a, int b) {
    const Vec3 m = (corners[static_cast<std::size_t>(a)] + corners[static_cast<std::size_t>(b)]) / 2;
    return std::to_string(m.x()) + " " + std::to_string(m.y()) + " " + std::to_string(m.z());
}

const std::string corner_rows = "1 0 0 0\n2 2 0 0\n3 0 2 0\n4 0 0 2\n";
const std::string gmsh_2 = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n";
const std::string gmsh_2_nodes = "$Nodes\n4\n" + corner_rows + "$EndNodes\n";
std::string gmsh_2_elements(const std::string& rows, int count = 1) {
    return "$Elements\n" + std::to_string(count) + "\n" + rows + "$EndElements\n";
}

TEST_F(ReadVolume, EveryFormatGivesBackTheMeshThatWasWritten) {
    for (const VolumeMesh& bar :
         {make_bar({0, 0, 0}, {3, 1, 1}, {3, 1, 1}), to_quadratic(make_bar({0, 0, 0}, {3, 1, 1}, {3, 1, 1}))}) {
        write_vtu(folder / "a.vtu", bar);
        write_gmsh(folder / "b.msh", bar, GmshVersion::v2_2);
        write_gmsh(folder / "c.MSH", bar, GmshVersion::v4_1);
        for (const char* name : {"a.vtu", "b.msh", "c.MSH"}) {
            const BodyFile body = read_body(folder / name);
            ASSERT_TRUE(body.volume) << name;
            EXPECT_EQ(body.volume->tetrahedra.cols(), bar.tetrahedra.cols()) << name;
            EXPECT_NEAR(element_volumes(*body.volume).sum(), 3, 1e-12) << name;  // rounding of 18 sums
            EXPECT_NEAR(signed_volume(body.surface), 3, 1e-12) << name;
            EXPECT_TRUE(body.notes.empty()) << name << ": " << body.notes.front();
            EXPECT_FALSE(body.is_in_mm);
        }
    }
}

TEST_F(ReadVolume, GmshCountsTheLastTwoMidsidesTheOtherWayRound) {
    // Gmsh's manual, "Node ordering": 8 lies on the edge (2,3), 9 on (1,3).
    const std::string nodes = "$Nodes\n10\n" + corner_rows + "5 " + middle(0, 1) + "\n6 " + middle(1, 2) + "\n7 " +
                              middle(2, 0) + "\n8 " + middle(0, 3) + "\n9 " + middle(2, 3) + "\n10 " + middle(1, 3) +
                              "\n$EndNodes\n";
    const BodyFile body = read("a.msh", gmsh_2 + nodes + gmsh_2_elements("1 11 2 1 1 1 2 3 4 5 6 7 8 9 10\n"));
    ASSERT_TRUE(body.volume && body.volume->is_quadratic());
    const Vec3 on_1_3 = body.volume->nodes.row(body.volume->tetrahedra(0, 8));
    EXPECT_EQ(on_1_3, (corners[1] + corners[3]) / 2);
    // VTK's order in a Gmsh file is refused: a midside is not on its edge.
    EXPECT_TRUE(says(refusal("b.msh", gmsh_2 + nodes + gmsh_2_elements("7 11 2 1 1 1 2 3 4 5 6 7 8 10 9\n")),
                     {"element 7", "node 9", "midside between nodes 2 and 4", "order"}));
}

TEST_F(ReadVolume, TetGenMidsidesStandInTetGensOrder) {
    // what TetGen 1.5 writes with -o2 for one tetrahedron: (2,3) (0,3) (0,1) (1,2) (1,3) (0,2)
    folder.write("a.ele", "1 10 1\n0 0 1 2 3 4 5 6 7 8 9 5\n");
    const BodyFile body =
        read("a.node", joined_lines({"# from TetGen", "10 3 0 0", "0 0 0 0", "1 2 0 0", "2 0 2 0", "3 0 0 2",
                                     "4 " + middle(2, 3), "5 " + middle(0, 3), "6 " + middle(0, 1), "7 " + middle(1, 2),
                                     "8 " + middle(1, 3), "9 " + middle(0, 2)}));
    ASSERT_TRUE(body.volume && body.volume->is_quadratic());
    const std::array<std::array<int, 2>, 6> of_vtk{{{0, 1}, {1, 2}, {2, 0}, {0, 3}, {1, 3}, {2, 3}}};
    for (int s = 0; s < 6; ++s) {
        const Vec3 ends = body.volume->nodes.row(body.volume->tetrahedra(0, of_vtk[s][0])) +
                          body.volume->nodes.row(body.volume->tetrahedra(0, of_vtk[s][1]));
        EXPECT_EQ(Vec3(body.volume->nodes.row(body.volume->tetrahedra(0, 4 + s))), ends / 2) << s;
    }
    EXPECT_EQ(body.files.size(), 2u);
}

TEST_F(ReadVolume, TetGenCountsFromNoughtOrOneAndEitherFileWillDo) {
    folder.write("a.node", "4 3 0 1\n" + std::string("1 0 0 0 1\n2 2 0 0 1\n3 0 2 0 1\n4 0 0 2 1\n"));
    const BodyFile body = read("a.ele", "1 4 0\n1 1 2 3 4\n");
    EXPECT_NEAR(element_volumes(*body.volume).sum(), corner_volume, 1e-12);
}

TEST_F(ReadVolume, Medit) {
    const std::string head = "MeshVersionFormatted 2\nDimension 3\nVertices\n4\n0 0 0 1\n2 0 0 1\n0 2 0 1\n0 0 2 1\n";
    const BodyFile body =
        read("a.mesh", head + "Triangles 1\n1 2 3 7\nTetrahedra\n1\n1 2 3 4 5\nRequiredVertices\n1\n1\nEnd\n");
    EXPECT_NEAR(element_volumes(*body.volume).sum(), corner_volume, 1e-12);
    EXPECT_TRUE(says(refusal("b.mesh", head + "Hexahedra\n1\n1 2 3 4 1 2 3 4 0\nEnd\n"), {"b.mesh", "Hexahedra"}));
    EXPECT_TRUE(says(refusal("c.mesh", head + "Tetrahedra\n1\n1 2 3 9 5\nEnd\n"), {"element 1", "node 9"}));
    EXPECT_TRUE(says(refusal("d.mesh", head + "Tetrahedra\n1\n1 2"), {"d.mesh", "cut off"}));
    EXPECT_TRUE(says(refusal("e.mesh", "solid x"), {"MeshVersionFormatted"}));
    EXPECT_TRUE(says(refusal("f.mesh", "MeshVersionFormatted 2\nDimension 2\n"), {"dimension is 2"}));
    EXPECT_TRUE(says(refusal("g.mesh", head + "Tetrahedra\n99999999\n1 2 3 4 1\n"), {"99999999", "bytes follow"}));
}

TEST_F(ReadVolume, GmshInBinary) {
    // Version 4.1: what is told in blocks, tags of eight bytes.
    std::string text = "$MeshFormat\n4.1 1 8\n";
    const auto put = [&](const auto& value) { text.append(reinterpret_cast<const char*>(&value), sizeof value); };
    const auto put_ints = [&](std::initializer_list<int> values) {
        for (const int v : values) put(v);
    };
    const auto put_longs = [&](std::initializer_list<std::int64_t> values) {
        for (const auto v : values) put(v);
    };
    put_ints({1});
    text += "\n$EndMeshFormat\n$Nodes\n";
    put_longs({1, 4, 1, 4});
    put_ints({3, 1, 0});
    put_longs({4, 1, 2, 3, 4});
    for (const Vec3& corner : corners)
        for (const double x : corner) put(x);
    text += "\n$EndNodes\n$Elements\n";
    put_longs({1, 1, 1, 1});
    put_ints({3, 1, 4});
    put_longs({1, 1, 1, 2, 3, 4});
    text += "\n$EndElements\n";
    EXPECT_NEAR(element_volumes(*read("a.msh", text).volume).sum(), corner_volume, 1e-12);

    // Version 2.2: elements of a type behind one head, tags of four bytes.
    text = "$MeshFormat\n2.2 1 8\n";
    put_ints({1});
    text += "\n$EndMeshFormat\n$Nodes\n4\n";
    for (int n = 0; n < 4; ++n) {
        put_ints({n + 1});
        for (const double x : corners[static_cast<std::size_t>(n)]) put(x);
    }
    text += "\n$EndNodes\n$Elements\n1\n";
    put_ints({4, 1, 2, 1, 7, 1, 1, 2, 3, 4});
    text += "\n$EndElements\n";
    EXPECT_NEAR(element_volumes(*read("b.msh", text).volume).sum(), corner_volume, 1e-12);
    EXPECT_TRUE(says(refusal("c.msh", text.substr(0, 100)), {"c.msh", "cut off"}));
}

TEST_F(ReadVolume, ElementsOfLowerDimensionAreSkippedAndSolidOnesNamed) {
    const std::string triangle = "1 2 2 1 1 1 2 3\n", tetrahedron = "2 4 2 1 1 1 2 3 4\n";
    EXPECT_EQ(
        read("a.msh", gmsh_2 + gmsh_2_nodes + gmsh_2_elements(triangle + tetrahedron, 2)).volume->tetrahedra.rows(), 1);
    EXPECT_TRUE(says(refusal("b.msh", gmsh_2 + gmsh_2_nodes + gmsh_2_elements(triangle)), {"b.msh", "no tetrahedra"}));
    EXPECT_TRUE(says(refusal("c.msh", gmsh_2 + gmsh_2_nodes + gmsh_2_elements("1 5 2 1 1 1 2 3 4 1 2 3 4\n")),
                     {"c.msh, line 13", "hexahedron of 8 nodes"}));
    EXPECT_TRUE(says(refusal("d.msh", gmsh_2 + gmsh_2_nodes + gmsh_2_elements("1 77 2 1 1 1 2\n")), {"type 77"}));
}

TEST_F(ReadVolume, GmshSaysWhatIsWrong) {
    EXPECT_TRUE(says(refusal("a.msh", "solid x"), {"$MeshFormat"}));
    EXPECT_TRUE(says(refusal("b.msh", "$MeshFormat\n4 0 8\n$EndMeshFormat\n"), {"format '4'", "4.1"}));
    EXPECT_TRUE(says(refusal("c.msh", gmsh_2 + "$Nodes\n2\n1 0 0 0\n2 x 0 0\n"), {"line 7", "'x'", "finite number"}));
    EXPECT_TRUE(says(refusal("d.msh", gmsh_2 + "$Nodes\n1000000\n1 0 0 0\n"), {"1000000", "bytes follow"}));
    EXPECT_TRUE(says(refusal("e.msh", gmsh_2 + gmsh_2_nodes + gmsh_2_elements("3 4 2 1 1 1 2 3 9\n")),
                     {"element 3", "node 9", "does not hold"}));
    EXPECT_TRUE(says(
        refusal("f.msh", gmsh_2 + "$Nodes\n2\n1 0 0 0\n1 0 0 1\n$EndNodes\n" + gmsh_2_elements("3 4 2 1 1 1 1 1 1\n")),
        {"node 1", "twice"}));
}

TEST_F(ReadVolume, GmshOfFormatOne) {
    const std::string nodes = "$NOD\n4\n" + corner_rows + "$ENDNOD\n";
    const BodyFile body = read("one.msh", nodes + "$ELM\n2\n1 2 7 1 3 1 2 3\n2 4 7 1 4 1 2 3 4\n$ENDELM\n");
    EXPECT_NEAR(element_volumes(*body.volume).sum(), corner_volume, 1e-12);
    EXPECT_TRUE(says(refusal("a.msh", nodes), {"nothing", "$ELM"}));
    EXPECT_TRUE(says(refusal("b.msh", "$NOD\n4\n" + corner_rows), {"$ENDNOD"}));
    EXPECT_TRUE(says(refusal("c.msh", nodes + "$ELM\n1\n2 4 7 1 5 1 2 3 4 4\n$ENDELM\n"), {"tells 5 nodes", "has 4"}));
    EXPECT_TRUE(says(refusal("d.msh", nodes + "$ELM\n1\n2 5 7 1 8 1 2 3 4 1 2 3 4\n$ENDELM\n"), {"hexahedron"}));
}

TEST_F(ReadVolume, ElementsInsideOutAreTurned) {
    const std::string one = "1 4 2 1 1 1 3 2 4\n";  // the other way round, and so are all: a convention
    BodyFile body = read("a.msh", gmsh_2 + gmsh_2_nodes + gmsh_2_elements(one));
    EXPECT_NEAR(element_volumes(*body.volume).minCoeff(), corner_volume, 1e-12);
    EXPECT_TRUE(body.notes.empty());
    // Of two neighbours one: a fault, and told.
    const std::string nodes = "$Nodes\n5\n" + corner_rows + "5 2 2 2\n$EndNodes\n";
    body = read("b.msh", gmsh_2 + nodes + gmsh_2_elements(one + "2 4 2 1 1 2 3 4 5\n", 2));
    EXPECT_GT(element_volumes(*body.volume).minCoeff(), 0);
    ASSERT_EQ(body.notes.size(), 1u);
    EXPECT_TRUE(says(body.notes[0], {"1 of 2", "inside out"}));
    EXPECT_EQ(body.surface.triangles.rows(), 6);
}

TEST_F(ReadVolume, ElementsWithoutVolumeOrWithCrowdedSidesAreNamed) {
    EXPECT_TRUE(says(refusal("a.msh", gmsh_2 + "$Nodes\n4\n1 0 0 0\n2 2 0 0\n3 0 2 0\n4 1 1 0\n$EndNodes\n" +
                                          gmsh_2_elements("5 4 2 1 1 1 2 3 4\n")),
                     {"element 5", "flat"}));
    const std::string twice = "1 4 2 1 1 1 2 3 4\n2 4 2 1 1 1 2 3 4\n3 4 2 1 1 1 2 3 4\n";
    EXPECT_TRUE(says(refusal("b.msh", gmsh_2 + gmsh_2_nodes + gmsh_2_elements(twice, 3)),
                     {"elements 1, 2 and 3", "share one side"}));
}

TEST_F(ReadVolume, MaterialsPartsLooseAndEqualNodesAreTold) {
    // Two tetrahedra with their own nodes each, one side at the same place, of two materials; and a loose node.
    const std::string nodes =
        "$Nodes\n9\n" + corner_rows + "5 2 0 0\n6 0 2 0\n7 0 0 2\n8 2 2 2\n9 50 50 50\n$EndNodes\n";
    const BodyFile body =
        read("a.msh", gmsh_2 + nodes + gmsh_2_elements("1 4 2 11 1 1 2 3 4\n2 4 2 12 2 5 6 7 8\n", 2));
    ASSERT_EQ(body.notes.size(), 3u);
    EXPECT_TRUE(says(body.notes[0], {"3 nodes lay on others"}));
    EXPECT_TRUE(says(body.notes[1], {"1 nodes belong to no tetrahedron"}));
    EXPECT_TRUE(says(body.notes[2], {"2 materials", "11 (1 elements)", "12 (1 elements)"}));
    EXPECT_EQ(body.volume->nodes.rows(), 5);
    EXPECT_EQ(body.surface.triangles.rows(), 6);

    const std::string apart = "$Nodes\n8\n" + corner_rows + "5 5 0 0\n6 7 0 0\n7 5 2 0\n8 5 0 2\n$EndNodes\n";
    const BodyFile two = read("b.msh", gmsh_2 + apart + gmsh_2_elements("1 4 2 1 1 1 2 3 4\n2 4 2 1 1 5 6 7 8\n", 2));
    ASSERT_EQ(two.notes.size(), 1u);
    EXPECT_TRUE(says(two.notes[0], {"2 parts", "held"}));
}

TEST_F(ReadVolume, VtuTellsMaterialsAndRefusesOtherCells) {
    VolumeMesh bar = make_bar({0, 0, 0}, {1, 1, 1}, {1, 1, 1});
    write_vtu(folder / "a.vtu", bar, {.points = {}, .cells = {{"MaterialIds", Eigen::VectorXd::LinSpaced(6, 1, 6)}}});
    EXPECT_TRUE(says(read_body(folder / "a.vtu").notes.at(0), {"6 materials"}));
    // what is no whole number is no material's
    for (const double value : {0.5, 1e300, double(INFINITY), std::nan("")}) {
        Eigen::VectorXd region = Eigen::VectorXd::LinSpaced(6, 1, 6);
        region[3] = value;
        write_vtu(folder / "a.vtu", bar, {.points = {}, .cells = {{"region", region}}});
        EXPECT_TRUE(read_body(folder / "a.vtu").notes.empty()) << value;
    }
    bar.nodes(0, 0) = std::nan("");
    write_vtu(folder / "b.vtu", bar);
    EXPECT_TRUE(says(message_of<InvalidInput>([&] { read_body(folder / "b.vtu"); }), {"point 0", "not finite"}));
    EXPECT_TRUE(says(refusal("c.vtu", "<VTKFile"), {"c.vtu", "no whole VTU"}));
}

TEST_F(ReadVolume, TetGenSaysWhatIsWrong) {
    EXPECT_TRUE(says(message_of<IoError>([&] { read_body(folder.write("a.node", "4 3 0 0\n")); }), {"a.ele", "side"}));
    folder.write("b.node", "4 3 0 0\n" + corner_rows);
    EXPECT_TRUE(says(refusal("b.ele", "1 6 0\n1 1 2 3 4 1 1\n"), {"6 nodes", "4 and 10"}));
    EXPECT_TRUE(says(refusal("b.ele", "2 4 0\n1 1 2 3 4\n"), {"1 of 2"}));
    EXPECT_TRUE(says(refusal("b.ele", "1000000 4 0\n1 1 2 3 4\n"), {"1000000", "bytes follow"}));
    EXPECT_TRUE(says(refusal("b.ele", "1 4 0\n1 1 2 3 8\n"), {"element 1", "node 8"}));
}

TEST_F(ReadVolume, PointCloudsAndUnknownFilesAreRefusedWithAHint) {
    for (const char* name : {"a.xyz", "a.pcd", "a.las"})
        EXPECT_TRUE(says(refusal(name, "0 0 0\n"), {name, "point cloud", "Poisson"}));
    EXPECT_TRUE(says(refusal("a.doc", "x"), {"'.doc'", ".step", ".nii.gz", ".msh"}));
    EXPECT_FALSE(is_body_file("a.doc"));
    EXPECT_TRUE(is_body_file("Liver.NII.GZ"));
    EXPECT_EQ(body_name("scans/liver.nii.gz"), "liver");
    EXPECT_EQ(body_name("a.b.stl"), "a.b");
}

}  // namespace
}  // namespace palpate::mesh
