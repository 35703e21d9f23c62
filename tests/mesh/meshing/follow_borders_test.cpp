#include "mesh/meshing/follow_borders.h"

#include <gtest/gtest.h>

#include <cmath>

#include "mesh/meshing/remesh.h"
#include "mesh/meshing/smooth_surface.h"
#include "mesh/meshing/tetrahedralise.h"
#include "mesh/topology/check_surface.h"

namespace palpate::mesh {
namespace {

/// Elements of nodes outside and of nodes within that are further from the border than 2 % of an edge.
int crossings(const VolumeMesh& body, const std::vector<Region>& regions, double edge) {
    const auto is_deep = [&](const Vec3& node) {
        for (int d = 0; d < 6; ++d)
            if (!contains(regions, Vec3(node + 0.02 * edge * (d % 2 == 0 ? 1 : -1) * Vec3::Unit(d / 2)))) return false;
        return contains(regions, node);
    };
    int count = 0;
    for (Eigen::Index e = 0; e < body.tetrahedra.rows(); ++e) {
        bool has_deep = false, has_outside = false;
        for (int c = 0; c < 4; ++c) {
            const Vec3 node = body.nodes.row(body.tetrahedra(e, c));
            has_deep |= is_deep(node);
            has_outside |= !contains(regions, node);
        }
        count += has_deep && has_outside;
    }
    return count;
}

/// 6 sqrt(2) V / (root mean square edge)^3 of the worst element that is not wholly within.
double worst_outside(const VolumeMesh& body, const std::vector<Region>& regions) {
    const std::vector<char> is_within = contains(regions, body.nodes);
    const Eigen::VectorXd volumes = element_volumes(body);
    double worst = 1;
    for (Eigen::Index e = 0; e < body.tetrahedra.rows(); ++e) {
        double squares = 0;
        int within = 0;
        for (int i = 0; i < 4; ++i) {
            within += is_within[body.tetrahedra(e, i)];
            for (int j = i + 1; j < 4; ++j)
                squares +=
                    (body.nodes.row(body.tetrahedra(e, i)) - body.nodes.row(body.tetrahedra(e, j))).squaredNorm();
        }
        if (within < 4) worst = std::min(worst, 6 * std::sqrt(2.0) * volumes[e] / std::pow(squares / 6, 1.5));
    }
    return worst;
}

VolumeMesh filled(const Surface& surface, double edge) {
    return tetrahedralise(remesh(surface, {.edge_length = edge, .volume_change = 0.06}), {.edge_length = edge});
}

double largest_x_within(const VolumeMesh& body, const std::vector<Region>& regions) {
    double x = -1e300;
    for (Eigen::Index n = 0; n < body.nodes.rows(); ++n)
        if (contains(regions, Vec3(body.nodes.row(n)))) x = std::max(x, body.nodes(n, 0));
    return x;
}

TEST(FollowBorders, ElementsEndAtThePlaneOfAClamp) {
    const Surface surface = make_box({0, 0, 0}, {100, 20, 20}, {10, 2, 2});
    const VolumeMesh plain = filled(surface, 7);
    // Through the middle of an element, near nodes, and next to the end.
    for (const double end : {1.0, 5.0, 7.0, 8.5, 12.0, 50.0}) {
        const std::vector<Region> clamp{BoxRegion{{-1, -1, -1}, {end, 21, 21}}};
        const VolumeMesh body = follow_borders(plain, clamp, surface);
        EXPECT_EQ(crossings(body, clamp, 7), 0) << end;
        EXPECT_NEAR(largest_x_within(body, clamp), end, 1e-9);
        EXPECT_NEAR(element_volumes(body).sum(), 40000, 1e-6) << end;
        EXPECT_GT(element_volumes(body).minCoeff(), 0) << end;
        EXPECT_GT(worst_outside(body, clamp), 0.01) << end;
        const Surface boundary = boundary_surface(body);
        EXPECT_TRUE(check_surface(boundary).sound()) << end;
        EXPECT_NEAR(area(boundary), 8800, 1e-6) << "corners and edges of the bar stay sharp, at " << end;
        EXPECT_EQ(boundary.vertices, body.nodes.topRows(boundary.vertices.rows())) << "the boundary's nodes come first";
        EXPECT_LT(body.nodes.rows(), plain.nodes.rows() * 8 / 5) << end;
    }
}

TEST(FollowBorders, WhereTheBorderLiesOnASideNothingChanges) {
    const Surface surface = make_box({0, 0, 0}, {100, 20, 20}, {10, 2, 2});
    const VolumeMesh plain = filled(surface, 7);
    for (const double end : {0.0, 0.05}) {
        const VolumeMesh body = follow_borders(plain, {BoxRegion{{-1, -1, -1}, {end, 21, 21}}}, surface);
        EXPECT_EQ(body.nodes, plain.nodes);
        EXPECT_EQ(body.tetrahedra, plain.tetrahedra);
    }
    PointsRegion points{.points = Points::Zero(1, 3), .within = 10};
    EXPECT_EQ(follow_borders(plain, {points}, surface).nodes, plain.nodes) << "their border is not known";
    EXPECT_EQ(follow_borders(plain, {}, surface).nodes, plain.nodes);
}

TEST(FollowBorders, OfSpheresAndSlabsInARoundBody) {
    const Surface surface = make_sphere({0, 0, 0}, 20, 4);
    const VolumeMesh plain = filled(surface, 6);
    const std::vector<Region> held{SphereRegion{{0, 0, 20}, 12},
                                   PlaneRegion{.point = {0, 0, -14}, .normal = {0, 0.2, 2}, .within = 5}};
    const VolumeMesh body = follow_borders(plain, held, surface);
    EXPECT_EQ(crossings(body, held, 6), 0);
    EXPECT_GT(element_volumes(body).minCoeff(), 0);
    EXPECT_TRUE(check_surface(boundary_surface(body)).sound());
    EXPECT_NEAR(element_volumes(body).sum(), element_volumes(plain).sum(), 0.001 * element_volumes(plain).sum());
    const VolumeMesh curved = curve_to(to_quadratic(body), surface, {.held = held});
    const VolumeMesh straight = to_quadratic(body);
    int left = 0;
    for (Eigen::Index n = 0; n < straight.nodes.rows(); ++n)
        left += contains(held, Vec3(straight.nodes.row(n))) && !contains(held, Vec3(curved.nodes.row(n)));
    EXPECT_EQ(left, 0) << "what was held still is, once elements are curved";
    EXPECT_NE(curved.nodes, straight.nodes);
}

/// A surface that dips to the edge on the other side of an element, but for rounding: cut there it would be flat.
TEST(FollowBorders, NoCutFlattensAnElement) {
    constexpr double height = 0.9;
    VolumeMesh body;
    body.nodes.resize(4, 3);
    body.nodes << 0, 0, 0, 10, 0, 0, 5, 5, height, 5, -5, height;
    body.tetrahedra.resize(1, 4);
    body.tetrahedra << 0, 1, 2, 3;
    if (element_volumes(body)[0] < 0) body.tetrahedra << 0, 1, 3, 2;
    body.faces = boundary_faces(body.tetrahedra);
    const Surface dip = make_box({-1, -6, height - 1e-12}, {11, 6, 5}, {1, 1, 1});
    const VolumeMesh cut = follow_borders(body, {BoxRegion{{-1, -9, -9}, {5, 9, 9}}}, dip);
    ASSERT_EQ(cut.tetrahedra.rows(), 2);
    EXPECT_GT(element_volumes(cut).minCoeff(), 0.49 * element_volumes(body)[0]);
}

TEST(FollowBorders, FixedNodesStay) {
    const Surface surface = make_box({0, 0, 0}, {100, 20, 20}, {10, 2, 2});
    const VolumeMesh plain = filled(surface, 7);
    const std::vector<char> all(plain.nodes.rows(), 1);
    const std::vector<Region> clamp{BoxRegion{{-1, -1, -1}, {12, 21, 21}}};
    const VolumeMesh body = follow_borders(plain, clamp, surface, all);
    EXPECT_EQ(crossings(body, clamp, 7), 0);
    for (Eigen::Index n = 0; n < plain.nodes.rows(); ++n)
        EXPECT_LT((body.nodes.rowwise() - plain.nodes.row(n)).rowwise().norm().minCoeff(), 1e-12) << n;
}

}  // namespace
}  // namespace palpate::mesh
