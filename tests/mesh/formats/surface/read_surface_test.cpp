#include "mesh/formats/surface/read_surface.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>

#include "mesh/core/surface.h"
#include "mesh/errors.h"
#include "mesh/formats/read_body.h"
#include "tests/messages.h"
#include "tests/temporary_folder.h"

namespace palpate::mesh {
namespace {

struct ReadSurface : ::testing::Test {
    Surface read(const std::string& name, const std::string& text) { return read_surface(folder.write(name, text)); }
    std::string refusal(const std::string& name, const std::string& text) {
        return message_of<InvalidInput>([&] { read(name, text); });
    }
    /// A binary STL of one triangle; its head promises `count`.
    std::string binary_stl(std::uint32_t count, float x = 1) {
        std::string bytes = "solid but binary";
        bytes.resize(80, ' ');
        const float numbers[12] = {0, 0, 1, 0, 0, 0, x, 0, 0, 0, 1, 0};
        bytes.append(reinterpret_cast<const char*>(&count), 4);
        bytes.append(reinterpret_cast<const char*>(numbers), sizeof numbers);
        bytes.append(2, '\0');
        return bytes;
    }
    TemporaryFolder folder;
};

// A tetrahedron of volume 1/6.
const std::string obj_vertices = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n";
const std::string obj_tetrahedron = obj_vertices + "f 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n";
const std::string ply_head =
    "ply\nformat ascii 1.0\ncomment by hand\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
    "element face 4\nproperty list uchar int vertex_indices\nend_header\n";
const std::string indexed_faces = "3 0 2 1\n3 0 1 3\n3 1 2 3\n3 0 3 2\n";
const std::string plain_vertices = "0 0 0\n1 0 0\n0 1 0\n0 0 1\n";

TEST_F(ReadSurface, EveryFormatGivesBackWhatWasWritten) {
    const Surface ball = make_sphere({1, 2, 3}, 4, 1);
    for (const char* name : {"a.obj", "a.PLY", "a.off", "a.vtp"}) {
        write_surface(folder / name, ball);
        const Surface read = read_surface(folder / name);
        EXPECT_EQ(read.vertices, ball.vertices) << name;
        EXPECT_EQ(read.triangles, ball.triangles) << name;
    }
    write_surface(folder / "a.stl", ball);
    const Surface read = read_surface(folder / "a.stl");
    EXPECT_EQ(read.vertices.rows(), 3 * ball.triangles.rows());                         // corners are not welded
    EXPECT_NEAR(signed_volume(read), signed_volume(ball), 1e-5 * signed_volume(ball));  // STL has 7 digits
}

TEST_F(ReadSurface, BinaryStlIsToldBySizeNotBySolid) { EXPECT_EQ(read("a.stl", binary_stl(1)).triangles.rows(), 1); }

TEST_F(ReadSurface, TextStl) {
    const Surface read = this->read("a.stl",
                                    "solid a name\r\n FACET normal 0 0 1\r\n outer loop\r\n vertex 0 0 0\r\n vertex "
                                    "1e0 0 0\r\n vertex 0 +1 0\r\n endloop\r\n"
                                    " endfacet\r\nendsolid\r\n");
    EXPECT_EQ(area(read), 0.5);
}

TEST_F(ReadSurface, ObjWithEverythingThatExportersWrite) {
    const Surface read = this->read("a.obj",
                                    "# made by hand\nmtllib x.mtl\no body\nv 0 0 0\nv 1 0 0 1.0\nv 0 1 0\nv 0 0 1\nvt "
                                    "0 0\nvn 0 0 1\ng sides\nusemtl grey\ns off\n"
                                    "f 1/1/1 3/1/1 2/1/1\nf 1//1 \\\n 2//1 4//1\nf -3/1 -2/1 -1/1\nf 1 4 3");
    EXPECT_EQ(read.triangles.rows(), 4);
    EXPECT_DOUBLE_EQ(signed_volume(read), 1.0 / 6);
}

TEST_F(ReadSurface, ConcavePolygonsKeepTheirAreaAndSide) {
    // An arrowhead whose fan from the first corner would lie outside, and an L of six corners.
    const Surface arrow = read("a.obj", "v 4 1 0\nv 0 0 0\nv 1 1 0\nv 0 2 0\nf 2 1 4 3\n");
    EXPECT_DOUBLE_EQ(area(arrow), 3);  // 4 less the notch of 1
    const Surface ell = read("b.off", "OFF\n6 1 0\n0 0 0\n3 0 0\n3 1 0\n1 1 0\n1 3 0\n0 3 0\n6 0 1 2 3 4 5\n");
    EXPECT_EQ(ell.triangles.rows(), 4);
    EXPECT_DOUBLE_EQ(area(ell), 5);
    EXPECT_GT(area_vectors(ell).col(2).minCoeff(), 0);
}

/// A face round a comb: every other corner is reflex.
std::string comb(int teeth) {
    std::string vertices, face = "f";
    for (int i = 0; i <= 2 * teeth; ++i)
        vertices += "v " + std::to_string(i) + " " + std::to_string(i % 2 == 0 ? 1 : 3) + " 0\n";
    vertices += "v " + std::to_string(2 * teeth) + " 0 0\nv 0 0 0\n";
    for (int v = 2 * teeth + 3; v >= 1; --v) face += " " + std::to_string(v);
    return vertices + face + "\n";
}

TEST_F(ReadSurface, LongFacesAreCutAndEndlessOnesRefused) {
    const Surface read = this->read("a.obj", comb(2000));
    EXPECT_EQ(read.triangles.rows(), 4001);
    EXPECT_NEAR(area(read), 2000 * 4, 1e-9);  // rounding; a tooth is 2 wide and 1 to 3 high
    EXPECT_TRUE(says(refusal("b.obj", comb(5000)), {"b.obj, line 10004", "10003 corners", "10000", "Triangulate"}));
    std::string many = comb(4900);
    const std::string face = many.substr(many.rfind("f "));
    for (int i = 0; i < 12; ++i) many += face;
    EXPECT_TRUE(says(refusal("c.obj", many), {"9803 corners", "behind many like it"}));
}

TEST_F(ReadSurface, VerticesThatNoFaceUsesAreLeftOut) {
    const BodyFile body =
        read_body(folder.write("a.obj", obj_vertices + "v 1e9 0 0\n" + obj_tetrahedron.substr(obj_vertices.size())));
    EXPECT_EQ(body.surface.vertices.rows(), 4);
    ASSERT_EQ(body.notes.size(), 1U);
    EXPECT_TRUE(says(body.notes[0], {"1 vertex that", "is left out"}));
}

TEST_F(ReadSurface, SizesBeyondMeaningAreRefused) {
    const auto scaled = [&](double scale, double shift) {
        Surface box = make_box({0, 0, 0}, {10, 4, 3}, {2, 1, 1});
        box.vertices = (scale * box.vertices).rowwise() + Eigen::RowVector3d(shift, 0, 0);
        write_surface(folder / "a.obj", box);
        return message_of<InvalidInput>([&] { read_body(folder / "a.obj"); });
    };
    EXPECT_EQ(scaled(1, 0), "");
    EXPECT_EQ(scaled(1e-6, 0), "");  // in micrometres of metres
    EXPECT_TRUE(says(scaled(1e-100, 0), {"a.obj", "spans 1.12e-99", "1e-12 to 1e+12", "--unit"}));
    EXPECT_TRUE(says(scaled(5e-324, 0), {"a.obj"}));
    EXPECT_TRUE(says(scaled(1e20, 0), {"1e-12 to 1e+12"}));
    EXPECT_TRUE(says(scaled(1, 1e12), {"away from the origin", "Move it"}));
}

TEST_F(ReadSurface, OffWithColoursAndComments) {
    const Surface read = this->read(
        "a.off",
        "COFF # head\n4 4 6\n0 0 0 1 1 1 1\n1 0 0 1 1 1 1\n# between\n0 1 0 1 1 1 1\n0 0 1 1 1 1 1\n" + indexed_faces);
    EXPECT_DOUBLE_EQ(signed_volume(read), 1.0 / 6);
}

TEST_F(ReadSurface, PlyBothEndiannesses) {
    for (const bool big : {false, true}) {
        std::string text =
            std::string("ply\nformat binary_") + (big ? "big" : "little") +
            "_endian 1.0\nelement vertex 4\nproperty uchar red\nproperty double x\nproperty double y\nproperty double "
            "z\n"
            "element face 4\nproperty list uchar uint vertex_index\nproperty list uchar float weights\nend_header\n";
        const auto add = [&]<class T>(T value) {
            char bytes[sizeof(T)];
            std::memcpy(bytes, &value, sizeof value);
            if (big) std::reverse(bytes, bytes + sizeof value);
            text.append(bytes, sizeof value);
        };
        const double positions[4][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
        for (const auto& position : positions) {
            text += '\x7f';
            for (const double x : position) add(x);
        }
        const std::uint32_t faces[4][3] = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}};
        for (const auto& face : faces) {
            text += '\3';
            for (const std::uint32_t v : face) add(v);
            text += '\1';
            add(1.5F);
        }
        EXPECT_DOUBLE_EQ(signed_volume(read("a.ply", text)), 1.0 / 6) << big;
        text.resize(text.size() - 30);
        EXPECT_TRUE(says(refusal("a.ply", text), {"face", "4", "cut off"}));
    }
}

TEST_F(ReadSurface, AFaceOfTwoCornersIsATriangleWithoutArea) {
    EXPECT_EQ(read("a.obj", obj_tetrahedron + "f 1 2\n").triangles.rows(), 5);
}

TEST_F(ReadSurface, TellsWhatIsWrongWithTheFile) {
    EXPECT_TRUE(says(message_of<IoError>([&] { read_surface(folder / "none.stl"); }), {"none.stl"}));
    EXPECT_TRUE(says(refusal("a.step", "x"), {"a.step", ".step", ".stl", ".obj", ".ply", ".off", ".vtp"}));
    for (const char* name : {"a.stl", "a.obj", "a.ply", "a.off", "a.vtp"})
        EXPECT_TRUE(says(refusal(name, " \n"), {name, "empty"}));
    for (const char* name : {"b.stl", "b.obj", "b.ply", "b.off", "b.vtp"})
        EXPECT_TRUE(says(refusal(name, "Dear all,\nthe mesh is attached.\n"), {name})) << name;
}

TEST_F(ReadSurface, TellsWhereAnStlIsWrong) {
    EXPECT_TRUE(says(refusal("a.stl", binary_stl(7)), {"7 triangles", "434 bytes", "134 bytes", "cut off"}));
    EXPECT_TRUE(says(refusal("a.stl", std::string(20, '\1')), {"20 bytes", "84"}));
    EXPECT_TRUE(says(refusal("a.stl", binary_stl(1, std::numeric_limits<float>::quiet_NaN())),
                     {"triangle 0", "nan", "not finite"}));
    const std::string begin = "solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\n";
    EXPECT_TRUE(says(refusal("a.stl", begin), {"endsolid", "cut off"}));
    EXPECT_TRUE(says(refusal("a.stl", begin + "vertex 0 inf 0\n"), {"line 6", "y coordinate", "inf"}));
    EXPECT_TRUE(says(refusal("a.stl", begin + "endloop\nendfacet\n"), {"line 7", "2 corners"}));
    EXPECT_TRUE(says(refusal("a.stl", begin + "facet\n"), {"line 6", "endfacet"}));
    EXPECT_TRUE(says(refusal("a.stl", begin + "corner 0 0\n"), {"line 6", "corner"}));
    EXPECT_TRUE(says(refusal("a.stl", "solid\nvertex 0 0 0\n"), {"line 2", "outside of a facet"}));
    EXPECT_TRUE(says(refusal("a.stl", "solid\nendsolid\n"), {"no vertices"}));
}

TEST_F(ReadSurface, TellsWhereAnObjIsWrong) {
    EXPECT_TRUE(says(refusal("a.obj", "v 0 0 0\nv 1 nan 0\n"), {"line 2", "y coordinate", "nan"}));
    EXPECT_TRUE(says(refusal("a.obj", "v 0 0\n"), {"line 1", "z coordinate", "missing"}));
    EXPECT_TRUE(says(refusal("a.obj", obj_vertices + "f 1 2 5\n"), {"line 5", "vertex 5", "1 to 4"}));
    EXPECT_TRUE(says(refusal("a.obj", obj_vertices + "f 1 2 -5\n"), {"line 5", "vertex -5", "4 vertices"}));
    EXPECT_TRUE(says(refusal("a.obj", obj_vertices + "f 0 1 2\n"), {"line 5", "0", "names no vertex"}));
    EXPECT_TRUE(says(refusal("a.obj", obj_vertices + "f 1\n"), {"line 5", "1 corner"}));
    EXPECT_TRUE(says(refusal("a.obj", obj_vertices), {"4 vertices", "point cloud"}));
    EXPECT_TRUE(says(refusal("a.obj", "vn 0 0 1\n"), {"no OBJ"}));
}

TEST_F(ReadSurface, TellsWhereAnOffIsWrong) {
    EXPECT_TRUE(says(refusal("a.off", "OFF\n4 4 0\n" + plain_vertices + "3 0 1 4\n3 0 1 2\n3 0 1 2\n3 0 1 2\n"),
                     {"line 7", "vertex 4", "0 to 3"}));
    EXPECT_TRUE(says(refusal("a.off", "OFF\n4 4 0\n" + plain_vertices + "3 0 1 2\n"), {"1 of 4 faces", "cut off"}));
    EXPECT_TRUE(says(refusal("a.off", "OFF\n2000000000 4 0\n0 0 0\n"), {"2000000000", "bytes"}));
    EXPECT_TRUE(says(refusal("a.off", "OFF\n-1 4 0\n0 0 0\n"), {"-1"}));
    EXPECT_TRUE(says(refusal("a.off", "OFF BINARY\n"), {"text"}));
}

TEST_F(ReadSurface, TellsWhereAPlyIsWrong) {
    EXPECT_TRUE(says(refusal("a.ply", "ply\nformat ascii 1.0\n"), {"end_header"}));
    EXPECT_TRUE(says(refusal("a.ply", "ply\nformat xml 1.0\nend_header\n"), {"line 2", "xml", "ascii"}));
    EXPECT_TRUE(says(refusal("a.ply", "ply\nend_header\n"), {"format"}));
    EXPECT_TRUE(says(refusal("a.ply", "ply\nproperty int x\nend_header\n"), {"line 2", "before any"}));
    EXPECT_TRUE(says(refusal("a.ply", "ply\nelement vertex -3\nend_header\n"), {"line 2", "-3"}));
    EXPECT_TRUE(
        says(refusal("a.ply", "ply\nelement vertex 3\nproperty real x\nend_header\n"), {"line 3", "real", "double"}));
    EXPECT_TRUE(says(refusal("a.ply", ply_head + plain_vertices + "3 0 1 4\n3 0 1 2\n3 0 1 2\n3 0 1 2\n"),
                     {"line 15", "vertex 4", "0 to 3"}));
    EXPECT_TRUE(says(refusal("a.ply", ply_head + "0 0 0\n1 x 0\n0 1 0\n0 0 1\n" + indexed_faces), {"line 12", "'x'"}));
    EXPECT_TRUE(says(refusal("a.ply", "ply\nformat ascii 1.0\nelement vertex 1\nproperty int a\nend_header\n1\n"),
                     {"x, y and z"}));
}

TEST_F(ReadSurface, PlyStripsTurnEveryOtherTriangleAndEndAtMinusOne) {
    const std::string head =
        "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\nelement "
        "tristrips 1\nproperty list int int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n1 1 0\n";
    const Surface both = read("a.ply", head + "4 0 1 2 3\n");
    EXPECT_EQ(both.triangles.rows(), 2);
    EXPECT_NEAR(area_vectors(both).col(2).sum(), 1, 1e-12);  // both look up
    const Surface rows = read("b.ply", head + "7 0 1 2 -1 1 3 2\n");
    EXPECT_EQ(rows.triangles.rows(), 2);
    EXPECT_NEAR(area_vectors(rows).col(2).sum(), 1, 1e-12);
    EXPECT_EQ(read("c.ply", head + "6 0 1 2 2 3 1\n").triangles.rows(), 2);  // a repeated corner makes none
    EXPECT_TRUE(says(refusal("d.ply", head + "3 0 1 7\n"), {"vertex 7", "0 to 3"}));
    EXPECT_TRUE(says(refusal("e.ply", head + "9 0 1 2\n"), {"the file ends here"}));
}

TEST_F(ReadSurface, AHostileCountTakesNoMemory) {
    const std::string head =
        "ply\nformat binary_little_endian 1.0\nelement vertex 4000000000\nproperty double x\nproperty double y\n"
        "property double z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n";
    EXPECT_TRUE(says(refusal("a.ply", head + std::string(1000, '\0')), {"4000000000", "1000 bytes", "41"}));
    EXPECT_TRUE(says(refusal("a.stl", binary_stl(4'000'000'000u)), {"4000000000 triangles", "enough for 1"}));
}

TEST_F(ReadSurface, TellsWhatIsWrongWithAVtp) {
    EXPECT_TRUE(says(refusal("a.vtp", "<VTKFile type=\"PolyData\"><PolyData>"), {"a.vtp", "VTP"}));
}

TEST_F(ReadSurface, AVtpNamesPointsThatAreThere) {
    const auto text = [](const std::string& corners, const std::string& ends) {
        return "<VTKFile type=\"PolyData\" version=\"0.1\"><PolyData><Piece NumberOfPoints=\"3\" NumberOfPolys=\"1\">"
               "<Points><DataArray type=\"Float64\" NumberOfComponents=\"3\" format=\"ascii\">0 0 0 1 0 0 0 1 "
               "0</DataArray></Points><Polys><DataArray type=\"Int64\" Name=\"connectivity\" format=\"ascii\">" +
               corners + "</DataArray><DataArray type=\"Int64\" Name=\"offsets\" format=\"ascii\">" + ends +
               "</DataArray></Polys></Piece></PolyData></VTKFile>";
    };
    EXPECT_EQ(read("a.vtp", text("0 1 2", "3")).triangles.rows(), 1);
    EXPECT_TRUE(says(refusal("a.vtp", text("0 1 3", "3")), {"cell 0", "point 3", "there are 3"}));
    EXPECT_TRUE(says(refusal("a.vtp", text("0 1 -1", "3")), {"cell 0", "point -1"}));
    EXPECT_TRUE(says(refusal("a.vtp", text("0 1 4294967298", "3")), {"cell 0", "point 4294967298"}));  // 2 in 32 bits
    EXPECT_TRUE(says(refusal("a.vtp", text("0 1 2", "4")), {"a.vtp"}));
}

TEST_F(ReadSurface, VtpStripsTurnEveryOtherTriangle) {
    const Surface strip = read(
        "a.vtp",
        "<VTKFile type=\"PolyData\" version=\"0.1\"><PolyData><Piece NumberOfPoints=\"4\" NumberOfStrips=\"1\"><Points>"
        "<DataArray type=\"Float64\" NumberOfComponents=\"3\" format=\"ascii\">0 0 0 1 0 0 0 1 0 1 1 "
        "0</DataArray></Points><Strips>"
        "<DataArray type=\"Int64\" Name=\"connectivity\" format=\"ascii\">0 1 2 3</DataArray>"
        "<DataArray type=\"Int64\" Name=\"offsets\" "
        "format=\"ascii\">4</DataArray></Strips></Piece></PolyData></VTKFile>");
    ASSERT_EQ(strip.triangles.rows(), 2);
    EXPECT_DOUBLE_EQ(area_vectors(strip)(0, 2), 0.5);
    EXPECT_DOUBLE_EQ(area_vectors(strip)(1, 2), 0.5);
}

}  // namespace
}  // namespace palpate::mesh
