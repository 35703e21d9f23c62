#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstring>

#include "mesh/formats/read_body.h"
#include "mesh/text/atomic_file.h"
#include "tests/messages.h"
#include "tests/temporary_folder.h"

namespace palpate::mesh {
namespace {

struct ReadLegacyVtk : ::testing::Test {
    TemporaryFolder folder;
    BodyFile read(const std::string& text) {
        write_text(folder / "body.vtk", text);
        return read_body(folder / "body.vtk");
    }
    std::string refusal(const std::string& text) {
        return message_of<InvalidInput>([&] { read(text); });
    }
};

std::string head(const char* version, const char* encoding, const char* dataset) {
    return std::string("# vtk DataFile Version ") + version + "\nby hand\n" + encoding + "\nDATASET " + dataset + "\n";
}

/// The corners of a cube of 2 mm, as VTK counts those of a hexahedron.
const char* const corners_of_cube = "0 0 0  2 0 0  2 2 0  0 2 0  0 0 2  2 0 2  2 2 2  0 2 2\n";
const std::string grid = head("3.0", "ASCII", "UNSTRUCTURED_GRID") + "POINTS 8 float\n" + corners_of_cube;

/// A number as legacy binary files hold it, big end first.
template <class Number>
std::string big(Number value) {
    std::string bytes(sizeof value, '\0');
    std::memcpy(bytes.data(), &value, sizeof value);
    if constexpr (std::endian::native == std::endian::little) std::ranges::reverse(bytes);
    return bytes;
}

TEST_F(ReadLegacyVtk, TetrahedraAndTheirMidsides) {
    EXPECT_EQ(read(head("2.0", "ASCII", "UNSTRUCTURED_GRID") +
                   "POINTS 4 double\n0 0 0 1 0 0 0 1 0 0 0 1\nCELLS 1 5\n4 0 1 2 3\nCELL_TYPES 1\n10\n")
                  .volume->tetrahedra.cols(),
              4);
    const std::string quadratic =
        "POINTS 10 double\n0 0 0 2 0 0 0 2 0 0 0 2 1 0 0 1 1 0 0 1 0 0 0 1 1 0 1 0 1 1\nCELLS 1 11\n10 0 1 2 3 4 5 6 7 "
        "8 9\nCELL_TYPES 1\n24\n";
    EXPECT_TRUE(read(head("4.2", "ASCII", "UNSTRUCTURED_GRID") + quadratic).volume->is_quadratic());
}

TEST_F(ReadLegacyVtk, HexahedraAndWedgesAreCut) {
    const BodyFile whole = read(grid + "CELLS 1 9\n8 0 1 2 3 4 5 6 7\nCELL_TYPES 1\n12\n");
    EXPECT_NEAR(element_volumes(*whole.volume).sum(), 8, 1e-9);
    EXPECT_EQ(whole.notes.size(), 1u);  // that they were cut
    const BodyFile wedges = read(grid + "CELLS 2 14\n6 0 1 2 4 5 6\n6 0 2 3 4 6 7\nCELL_TYPES 2\n13\n13\n");
    EXPECT_NEAR(element_volumes(*wedges.volume).sum(), 8, 1e-9);
    EXPECT_NEAR(area(wedges.surface), 24, 1e-9);
}

TEST_F(ReadLegacyVtk, VersionFiveCountsCellsByOffsets) {
    const BodyFile body = read(head("5.1", "ASCII", "UNSTRUCTURED_GRID") + "POINTS 8 float\n" + corners_of_cube +
                               "CELLS 2 8\nOFFSETS vtktypeint64\n0 8\nCONNECTIVITY vtktypeint64\n0 1 2 3 4 5 6 "
                               "7\nCELL_TYPES 1\n12\n");
    EXPECT_NEAR(element_volumes(*body.volume).sum(), 8, 1e-9);
}

TEST_F(ReadLegacyVtk, PolygonsStripsAndFlatCellsAreASurface) {
    const std::string sides = "POLYGONS 6 30\n4 0 3 2 1\n4 4 5 6 7\n4 0 1 5 4\n4 1 2 6 5\n4 2 3 7 6\n4 3 0 4 7\n";
    const BodyFile poly = read(head("3.0", "ASCII", "POLYDATA") + "POINTS 8 float\n" + corners_of_cube + sides);
    EXPECT_FALSE(poly.volume);
    EXPECT_NEAR(signed_volume(poly.surface), 8, 1e-9);
    const BodyFile flat = read(grid +
                               "CELLS 6 30\n4 0 3 2 1\n4 4 5 6 7\n4 0 1 5 4\n4 1 2 6 5\n4 2 3 7 6\n4 3 0 4 7\n"
                               "CELL_TYPES 6\n9\n9\n9\n9\n9\n9\n");
    EXPECT_NEAR(signed_volume(flat.surface), 8, 1e-9);
}

TEST_F(ReadLegacyVtk, Binary) {
    std::string text = head("3.0", "BINARY", "UNSTRUCTURED_GRID") + "POINTS 4 float\n";
    for (const float c : {0.F, 0.F, 0.F, 1.F, 0.F, 0.F, 0.F, 1.F, 0.F, 0.F, 0.F, 1.F}) text += big(c);
    text += "\nCELLS 1 5\n";
    for (const std::int32_t i : {4, 0, 1, 2, 3}) text += big(i);
    text += "\nCELL_TYPES 1\n" + big(std::int32_t{10}) + "\n";
    EXPECT_NEAR(element_volumes(*read(text).volume).sum(), 1. / 6, 1e-9);
    EXPECT_TRUE(says(refusal(text.substr(0, 130)), {"body.vtk"}));  // cut off
}

TEST_F(ReadLegacyVtk, SaysWhatIsWrong) {
    EXPECT_TRUE(says(refusal("solid x"), {"body.vtk", "no whole legacy VTK file"}));
    EXPECT_TRUE(
        says(refusal(head("3.0", "ASCII", "STRUCTURED_POINTS") + "DIMENSIONS 2 2 2\nORIGIN 0 0 0\nSPACING 1 1 1\n"),
             {"POLYDATA or UNSTRUCTURED_GRID"}));
    EXPECT_TRUE(says(refusal(grid + "CELLS 1 9\n8 0 1 2 3 4 5 6 70\nCELL_TYPES 1\n12\n"), {"cell 0", "70"}));
    EXPECT_TRUE(says(refusal(head("3.0", "ASCII", "POLYDATA") + "POINTS 99999999 float\n0 0 0\n"),
                     {"announces 99999999 entries"}));
    EXPECT_TRUE(says(refusal(grid), {"no faces"}));
}

}  // namespace
}  // namespace palpate::mesh
