#include "mesh/core/volume_mesh.h"

#include <gtest/gtest.h>

#include <set>
#include <vector>

namespace palpate::mesh {
namespace {

VolumeMesh small_bar() { return make_bar({0, 0, 0}, {4, 2, 3}, {4, 2, 3}); }

TEST(MakeBar, FillsTheBoxWithPositiveElements) {
    const VolumeMesh bar = small_bar();
    EXPECT_EQ(bar.tetrahedra.rows(), 6 * 24);
    EXPECT_EQ(bar.nodes.rows(), 5 * 3 * 4);
    // All six tetrahedra of a cell have a sixth of its volume.
    EXPECT_LT((element_volumes(bar).array() - 1.0 / 6).abs().maxCoeff(), 1e-14);
}

TEST(BoundaryFaces, AreClosedOutwardAndEncloseTheElements) {
    const VolumeMesh bar = make_bar({-1, 0, 5}, {3, 2, 8}, {3, 2, 2});
    const Surface boundary = boundary_surface(bar);
    EXPECT_NEAR(signed_volume(boundary), element_volumes(bar).sum(), 1e-12);
    EXPECT_NEAR(signed_volume(boundary), 24, 1e-12);
    EXPECT_NEAR(area(boundary), 2 * (8 + 12 + 6), 1e-12);             // nothing from inside
    EXPECT_LT(area_vectors(boundary).colwise().sum().norm(), 1e-12);  // closed, oriented
}

TEST(BoundaryFaces, OfASingleElementAreItsFourSidesWithTheirMidsides) {
    VolumeMesh one;
    one.nodes.resize(4, 3);
    one.nodes << 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1;
    one.tetrahedra.resize(1, 4);
    one.tetrahedra << 0, 1, 2, 3;
    const VolumeMesh quadratic = to_quadratic(one);
    const Faces faces = boundary_faces(quadratic.tetrahedra);
    ASSERT_EQ(faces.rows(), 4);
    ASSERT_EQ(faces.cols(), 6);
    for (int f = 0; f < 4; ++f)
        for (int s = 0; s < 3; ++s) {
            const Vec3 middle = (quadratic.nodes.row(faces(f, s)) + quadratic.nodes.row(faces(f, (s + 1) % 3))) / 2;
            EXPECT_EQ(Vec3(quadratic.nodes.row(faces(f, 3 + s))), middle);
        }
}

TEST(ToQuadratic, SharesTheMidsidesBetweenElementsAndFaces) {
    const VolumeMesh quadratic = to_quadratic(small_bar());
    // Nodes of a bar cut in halves along each axis: corners and midsides together are the finer lattice.
    EXPECT_EQ(quadratic.nodes.rows(), 9 * 5 * 7);
    std::set<std::vector<double>> places;
    for (const auto& node : quadratic.nodes.rowwise()) places.insert({node[0], node[1], node[2]});
    EXPECT_EQ(places.size(), static_cast<std::size_t>(quadratic.nodes.rows()));
    EXPECT_EQ(quadratic.faces, boundary_faces(quadratic.tetrahedra));
}

TEST(ToQuadratic, PutsTheMidsidesWhereVtkHasThem) {
    const VolumeMesh quadratic = to_quadratic(small_bar());
    const int ends[6][2] = {{0, 1}, {1, 2}, {2, 0}, {0, 3}, {1, 3}, {2, 3}};
    for (Eigen::Index e = 0; e < quadratic.tetrahedra.rows(); ++e)
        for (int s = 0; s < 6; ++s) {
            const auto node = [&](int c) { return Vec3(quadratic.nodes.row(quadratic.tetrahedra(e, c))); };
            ASSERT_EQ(node(4 + s), (node(ends[s][0]) + node(ends[s][1])) / 2);
        }
}

TEST(ToQuadratic, LeavesAQuadraticMeshAsItIs) {
    const VolumeMesh once = to_quadratic(small_bar());
    const VolumeMesh twice = to_quadratic(once);
    EXPECT_EQ(twice.nodes, once.nodes);
    EXPECT_EQ(twice.tetrahedra, once.tetrahedra);
}

TEST(BoundarySurface, CutsQuadraticFacesIntoFourAndKeepsTheBody) {
    const VolumeMesh bar = small_bar();
    const VolumeMesh quadratic = to_quadratic(bar);
    Eigen::VectorXi node_of_vertex;
    const Surface surface = boundary_surface(quadratic, &node_of_vertex);
    EXPECT_EQ(surface.triangles.rows(), 4 * bar.faces.rows());
    EXPECT_NEAR(signed_volume(surface), 24, 1e-12);
    EXPECT_NEAR(area(surface), 52, 1e-12);
    ASSERT_EQ(node_of_vertex.size(), surface.vertices.rows());
    for (Eigen::Index v = 0; v < surface.vertices.rows(); ++v)
        EXPECT_EQ(Vec3(surface.vertices.row(v)), Vec3(quadratic.nodes.row(node_of_vertex[v])));
}

}  // namespace
}  // namespace palpate::mesh
