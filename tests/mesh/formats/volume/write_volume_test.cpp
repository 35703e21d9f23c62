#include "mesh/formats/volume/write_volume.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include <array>
#include <sstream>

#include "mesh/text/atomic_file.h"
#include "tests/messages.h"
#include "tests/temporary_folder.h"

namespace palpate::mesh {
namespace {

/// The lines that follow one which begins so, up to the next with a star.
std::vector<std::string> block(const std::string& text, const std::string& keyword) {
    std::istringstream lines(text);
    std::string line;
    std::vector<std::string> found;
    bool inside = false;
    while (std::getline(lines, line)) {
        if (line.starts_with("*"))
            inside = line.starts_with(keyword);
        else if (inside)
            found.push_back(line);
    }
    return found;
}

std::vector<double> numbers(std::string line) {
    for (char& c : line)
        if (c == ',' || c == 'S') c = ' ';
    std::istringstream words(line);
    std::vector<double> values;
    for (double value; words >> value;) values.push_back(value);
    return values;
}

TEST(InpFile, MidsidesStandOnTheEdgesThatCalculixDocuments) {
    // CalculiX manual, "Ten-node tetrahedral element": 5 on 1-2, 6 on 2-3, 7 on 3-1, 8 on 1-4, 9 on 2-4, 10 on 3-4.
    constexpr std::array<std::array<std::size_t, 3>, 6> edges{
        {{5, 1, 2}, {6, 2, 3}, {7, 3, 1}, {8, 1, 4}, {9, 2, 4}, {10, 3, 4}}};
    const TemporaryFolder folder;
    const VolumeMesh bar = to_quadratic(make_bar({0, 0, 0}, {2, 1, 1}, {2, 1, 1}));
    write_inp(folder / "bar.inp", bar, {std::vector<char>(static_cast<std::size_t>(bar.nodes.rows()), 0), {1, 0.3, 1}});
    const std::string text = read_text(folder / "bar.inp");
    const auto nodes = block(text, "*NODE"), elements = block(text, "*ELEMENT");
    ASSERT_EQ(std::ssize(nodes), bar.nodes.rows());
    ASSERT_EQ(std::ssize(elements), bar.tetrahedra.rows());
    EXPECT_TRUE(says(text, {"TYPE=C3D10", "made by palpate"}));
    const auto at = [&](double node) {
        const auto row = numbers(nodes[static_cast<std::size_t>(node) - 1]);
        return Vec3(row[1], row[2], row[3]);
    };
    for (const std::string& line : elements) {
        const auto row = numbers(line);  // number, nodes 1 to 10
        for (const auto& [middle, a, b] : edges) EXPECT_EQ(at(row[middle]), (at(row[a]) + at(row[b])) / 2);
    }
}

TEST(InpFile, SidesOfTheSkinLookOutwardAndCloseIt) {
    // Abaqus: S1 is 1-2-3, S2 1-4-2, S3 2-4-3, S4 3-4-1.
    constexpr std::array<std::array<int, 3>, 4> sides{{{0, 1, 2}, {0, 3, 1}, {1, 3, 2}, {2, 3, 0}}};
    const TemporaryFolder folder;
    const VolumeMesh bar = make_bar({1, 1, 1}, {3, 2, 2}, {2, 1, 1});
    std::vector<char> held(static_cast<std::size_t>(bar.nodes.rows()), 0);
    held[0] = held[3] = 1;
    write_inp(folder / "bar.inp", bar, {held, {0.5, 0.3, 1e-9}});
    const std::string text = read_text(folder / "bar.inp");
    const auto skin = block(text, "*SURFACE");
    EXPECT_EQ(std::ssize(skin), bar.faces.rows());
    double volume = 0;  // by the divergence theorem; the sides of a C3D4 run clockwise seen from outside
    for (const std::string& line : skin) {
        const auto row = numbers(line);
        const auto& side = sides[static_cast<std::size_t>(row[1]) - 1];
        Mat3 corner;
        for (int c = 0; c < 3; ++c)
            corner.col(c) =
                bar.nodes.row(bar.tetrahedra(static_cast<Eigen::Index>(row[0]) - 1, side[static_cast<std::size_t>(c)]));
        volume -= corner.col(0).dot(corner.col(1).cross(corner.col(2))) / 6;
    }
    EXPECT_NEAR(volume, 2, 1e-12);  // rounding of 20 sums
    EXPECT_EQ(block(text, "*NSET, NSET=NHELD"), std::vector<std::string>{"1, 4"});
    EXPECT_EQ(numbers(block(text, "*ELASTIC")[0]), (std::vector<double>{0.5, 0.3}));
}

TEST(GmshFile, MidsidesStandOnTheEdgesThatGmshDocuments) {
    // Gmsh reference manual, "Node ordering", Tetrahedron10: 4 (0,1), 5 (1,2), 6 (2,0), 7 (3,0), 8 (3,2), 9 (3,1).
    constexpr std::array<std::array<std::size_t, 3>, 6> edges{
        {{4, 0, 1}, {5, 1, 2}, {6, 2, 0}, {7, 3, 0}, {8, 3, 2}, {9, 3, 1}}};
    const TemporaryFolder folder;
    const VolumeMesh bar = to_quadratic(make_bar({0, 0, 0}, {2, 1, 1}, {2, 1, 1}));
    write_gmsh(folder / "bar.msh", bar, GmshVersion::v2_2);
    std::istringstream words(read_text(folder / "bar.msh"));
    int tetrahedra = 0;
    for (std::string line; std::getline(words, line);) {
        const auto row = numbers(line);
        if (row.size() != 15 || row[1] != 11) continue;  // number, type, two tags and their count, ten nodes
        ++tetrahedra;
        const auto at = [&](std::size_t node) {
            return Vec3(bar.nodes.row(static_cast<Eigen::Index>(row[5 + node]) - 1));
        };
        for (const auto& [middle, a, b] : edges) EXPECT_EQ(at(middle), (at(a) + at(b)) / 2);
    }
    EXPECT_EQ(tetrahedra, bar.tetrahedra.rows());
}

}  // namespace
}  // namespace palpate::mesh
