#include "mesh/formats/vtk/vtk_files.h"

#include <gtest/gtest.h>

#include "mesh/errors.h"
#include "mesh/formats/surface/read_surface.h"
#include "mesh/text/atomic_file.h"
#include "tests/messages.h"
#include "tests/temporary_folder.h"

namespace palpate::mesh {
namespace {

/// Numbers with all their digits in use.
Eigen::MatrixXd uneven(Eigen::Index rows, Eigen::Index columns) {
    return Eigen::VectorXd::LinSpaced(rows * columns, -1.0 / 3, 2.0 / 7).reshaped(rows, columns);
}

VolumeMesh uneven_bar() {
    VolumeMesh mesh = make_bar({0, 0, 0}, {2, 1, 1}, {2, 1, 1});
    mesh.nodes /= 3;
    return mesh;
}

TEST(Vtu, IsReadBackEqual) {
    const TemporaryFolder folder;
    for (const VolumeMesh& mesh : {uneven_bar(), to_quadratic(uneven_bar())}) {
        const MeshData written{
            {{"displacement", uneven(mesh.nodes.rows(), 3)}, {"error [mm]", uneven(mesh.nodes.rows(), 1)}},
            {{"stress [MPa]", uneven(mesh.tetrahedra.rows(), 6)}}};
        write_vtu(folder / "body.vtu", mesh, written);
        MeshData data;
        const VolumeMesh read = read_vtu(folder / "body.vtu", &data);
        EXPECT_EQ(read.nodes, mesh.nodes);
        EXPECT_EQ(read.tetrahedra, mesh.tetrahedra);
        EXPECT_EQ(read.faces, mesh.faces);
        ASSERT_EQ(data.points.size(), 2u);
        ASSERT_EQ(data.cells.size(), 1u);
        EXPECT_EQ(data.points[0].name, "displacement");
        EXPECT_EQ(data.points[0].values, written.points[0].values);
        EXPECT_EQ(data.points[1].name, "error [mm]");
        EXPECT_EQ(data.points[1].values, written.points[1].values);
        EXPECT_EQ(data.cells[0].values, written.cells[0].values);
    }
}

TEST(Vtp, KeepsEveryDigitOfASurface) {
    const TemporaryFolder folder;
    const Surface sphere = make_sphere({1.0 / 3, 0, 0}, 2.0 / 3, 2);
    write_vtp(folder / "sphere.vtp", sphere, {{{"error [mm]", uneven(sphere.vertices.rows(), 1)}}, {}});
    const Surface read = read_surface(folder / "sphere.vtp");
    EXPECT_EQ(read.vertices, sphere.vertices);
    EXPECT_EQ(read.triangles, sphere.triangles);
}

TEST(VtpLines, HoldsLinesOrElseVertices) {
    const TemporaryFolder folder;
    const Points points = uneven(3, 3);
    Eigen::Matrix<int, Eigen::Dynamic, 2> lines(2, 2);
    lines << 0, 1, 1, 2;
    write_vtp_lines(folder / "lines.vtp", points, lines,
                    {{{"radius [mm]", uneven(3, 1)}}, {{"force [N]", uneven(2, 3)}}});
    write_vtp_lines(folder / "points.vtp", points, {}, {{}, {{"error [mm]", uneven(3, 1)}}});
    EXPECT_TRUE(says(read_text(folder / "lines.vtp"), {"NumberOfPoints=\"3\"", "NumberOfVerts=\"0\"",
                                                       "NumberOfLines=\"2\"", "radius [mm]", "force [N]"}));
    EXPECT_TRUE(says(read_text(folder / "points.vtp"), {"NumberOfVerts=\"3\"", "NumberOfLines=\"0\"", "error [mm]"}));
}

TEST(Pvd, NamesItsStepsRelativeToItself) {
    const TemporaryFolder folder;
    write_pvd(folder / "run/ladder.pvd", {{0, folder / "run/steps/0.vtp"}, {0.5, folder / "R&D.vtp"}});
    EXPECT_TRUE(says(
        read_text(folder / "run/ladder.pvd"),
        {"type=\"Collection\"", "timestep=\"0\" file=\"steps/0.vtp\"", "timestep=\"0.5\" file=\"../R&amp;D.vtp\""}));
}

/// A text VTU of five points with these cells.
std::string text_vtu(const std::string& connectivity, const std::string& offsets, const std::string& types,
                     const std::string& last_point = "1 1 1") {
    const auto count = std::to_string(std::count(types.begin(), types.end(), ' ') + (types.empty() ? 0 : 1));
    return "<VTKFile type=\"UnstructuredGrid\" version=\"0.1\" byte_order=\"LittleEndian\"><UnstructuredGrid>"
           "<Piece NumberOfPoints=\"5\" NumberOfCells=\"" +
           count +
           "\"><Points>"
           "<DataArray type=\"Float64\" NumberOfComponents=\"3\" format=\"ascii\">0 0 0 1 0 0 0 1 0 0 0 1 " +
           last_point +
           "</DataArray></Points><Cells>"
           "<DataArray type=\"Int64\" Name=\"connectivity\" format=\"ascii\">" +
           connectivity +
           "</DataArray>"
           "<DataArray type=\"Int64\" Name=\"offsets\" format=\"ascii\">" +
           offsets +
           "</DataArray>"
           "<DataArray type=\"UInt8\" Name=\"types\" format=\"ascii\">" +
           types +
           "</DataArray>"
           "</Cells></Piece></UnstructuredGrid></VTKFile>";
}

TEST(Vtk, FilesSayWhoMadeThem) {
    // so that a command may replace what it wrote before
    const TemporaryFolder folder;
    write_vtu(folder / "body.vtu", uneven_bar());
    write_pvd(folder / "series.pvd", {{0, folder / "body.vtu"}});
    for (const char* name : {"body.vtu", "series.pvd"}) {
        std::ifstream in(folder / name, std::ios::binary);
        std::string line;
        std::getline(in, line);
        EXPECT_EQ(line.rfind("<?xml", 0), 0u) << name;
        std::getline(in, line);
        EXPECT_EQ(line, "<!-- made by palpate -->") << name;
    }
}

TEST(Vtu, OfOtherProgramsIsRead) {
    const TemporaryFolder folder;
    const VolumeMesh mesh = read_vtu(folder.write("body.vtu", text_vtu("0 1 2 3", "4", "10")));
    EXPECT_EQ(mesh.tetrahedra.rows(), 1);
    EXPECT_EQ(mesh.faces.rows(), 4);
}

TEST(Vtu, SaysWhatIsWrong) {
    const TemporaryFolder folder;
    const auto refusal = [&](const std::string& text) {
        return message_of<InvalidInput>([&] { read_vtu(folder.write("body.vtu", text)); });
    };
    EXPECT_TRUE(says(message_of<IoError>([&] { read_vtu(folder / "none.vtu"); }), {"none.vtu", "no such file"}));
    EXPECT_TRUE(says(refusal("solid x\n"), {"body.vtu", "no whole VTU file"}));
    EXPECT_TRUE(says(refusal(text_vtu("0 1 2 3", "4", "10").substr(0, 300)), {"no whole VTU file"}));
    EXPECT_TRUE(says(refusal(text_vtu("", "", "")), {"body.vtu", "no cells"}));
    EXPECT_TRUE(says(refusal(text_vtu("0 1 2", "3", "5")), {"cell 0", "type 5", "Tetrahedra"}));
    EXPECT_TRUE(says(refusal(text_vtu("0 1 2 3 0 1 2", "4 7", "10 5")), {"cell 1", "type 5", "one kind"}));
    EXPECT_TRUE(says(refusal(text_vtu("0 1 2 9", "4", "10")), {"cell 0", "point 9", "5"}));
    EXPECT_TRUE(says(refusal(text_vtu("0 1 2", "3", "10")), {"cell 0", "3 nodes", "4"}));
    EXPECT_TRUE(says(refusal(text_vtu("1 2 3 4 0 2 1 3", "4 8", "10 10")), {"element 1", "inside out"}));
    EXPECT_TRUE(says(refusal(text_vtu("0 1 2 3", "4", "10", "1 nan 1")), {"point 4", "not finite"}));
}

TEST(Vtk, FilesThatCannotBeWrittenAreNamed) {
    const TemporaryFolder folder;
    const auto file = folder.write("file", "x");
    EXPECT_TRUE(
        says(message_of<IoError>([&] { write_vtu(file / "body.vtu", uneven_bar()); }), {"file", "cannot be made"}));
}

}  // namespace
}  // namespace palpate::mesh
