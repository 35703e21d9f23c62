#include "fem/elements/patch_load.h"

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include "mesh/errors.h"
#include "tests/fem/bodies.h"
#include "tests/messages.h"

namespace palpate::fem {
namespace {

using testing::HasSubstr;

constexpr double size = 20;

class PatchLoad : public testing::TestWithParam<Kind> {
protected:
    /// A block whose top is z = 10, too coarse for the patches.
    const mesh::VolumeMesh block = jittered_bar(GetParam(), {size, size, 10}, {5, 5, 2});
};

INSTANTIATE_TEST_SUITE_P(AllElements, PatchLoad, testing::Values(Kind::linear, Kind::quadratic, Kind::curved));

Vec3 node_force(const Eigen::SparseMatrix<double>& loads, Eigen::Index node, Eigen::Index contact = 0) {
    return {loads.coeff(3 * node, contact), loads.coeff(3 * node + 1, contact), loads.coeff(3 * node + 2, contact)};
}

/// Sum over the nodes of f(x_i) times the node's share of a unit force along z: the mean of f over the patch, where the
/// elements can represent f.
template <class F>
double mean_over_patch(const mesh::VolumeMesh& mesh, const Eigen::SparseMatrix<double>& loads, F&& f) {
    double sum = 0;
    for (Eigen::Index i = 0; i < mesh.nodes.rows(); ++i) {
        sum += node_force(loads, i).z() * f(Vec3(mesh.nodes.row(i)));
    }
    return sum;
}

TEST_P(PatchLoad, NodalForcesAddUpToTheForce) {
    const std::vector<mesh::Contact> contacts{{{7, 9, 10}, {1, 2, -3}, 3.3},
                                              {{0, 0, 0}, {-1, 0, 2}, 5},
                                              {{10, 10, 10}, {0, 0, 1}, 0},
                                              {{20, 11, 5}, {4, 4, 4}, 0.01}};
    const auto loads = patch_loads(block, contacts, 1.0);
    ASSERT_EQ(loads.cols(), 4);
    for (Eigen::Index c = 0; c < loads.cols(); ++c) {
        Vec3 sum = Vec3::Zero();
        for (Eigen::Index i = 0; i < block.nodes.rows(); ++i) sum += node_force(loads, i, c);
        // Rounding.
        EXPECT_LT((sum - contacts[c].force).norm(), 1e-14 * contacts[c].force.norm()) << c;
    }
}

TEST_P(PatchLoad, ActsAtTheContact) {
    const Vec3 at(8.3, 9.1, 10), force(0.3, 0.2, 1);
    const double radius = 3;
    const auto loads = patch_loads(block, {{at, force, radius}}, 1.0);
    Vec3 moment = Vec3::Zero();
    for (Eigen::Index i = 0; i < block.nodes.rows(); ++i) {
        const Vec3 arm = block.nodes.row(i).transpose() - at;
        moment += arm.cross(node_force(loads, i));
    }
    // Sub-triangles on the rim make the disc ragged: by less than one of them, radius / 12 over the rim's many. A
    // curved top stands off its plane by its bows besides.
    const double bow = GetParam() == Kind::curved ? 0.03 * size / 5 : 0;
    EXPECT_LT(moment.norm(), (0.01 * radius + bow) * force.norm());
}

TEST(PatchLoadDisc, HasTheAreaOfADisc) {
    // Quadratic shape functions represent |x - c|^2, whose mean over a disc is r^2 / 2: the patch's area over 2 pi.
    const auto block = jittered_bar(Kind::quadratic, {size, size, 10}, {5, 5, 2});
    const Vec3 at(8.3, 9.1, 10);
    for (const double radius : {0.3, 1.0, 3.0, 8.0}) {
        const auto loads = patch_loads(block, {{at, Vec3::UnitZ(), radius}}, 1.0);
        const double square = mean_over_patch(block, loads, [&](const Vec3& x) { return (x - at).squaredNorm(); });
        // A ragged rim of cells of radius / 24 to radius / 12 averages out to a thousandth.
        EXPECT_NEAR(2 * std::numbers::pi * square, std::numbers::pi * radius * radius,
                    1e-3 * std::numbers::pi * radius * radius);
    }
}

TEST_P(PatchLoad, DoesNotReachThroughTheBody) {
    const auto loads = patch_loads(block, {{{9, 9, 10}, Vec3::UnitZ(), 4}}, 1.0);
    for (Eigen::Index i = 0; i < block.nodes.rows(); ++i) {
        if (block.nodes(i, 2) > 9) continue;
        EXPECT_EQ(node_force(loads, i).norm(), 0) << i;
    }
}

TEST_P(PatchLoad, WithoutRadiusTakesTheNearestPoint) {
    const Vec3 node(8, 12, 10), force(1, -2, 3);
    for (const double off : {0.0, 0.4}) {
        const auto loads = patch_loads(block, {{node + Vec3(0, 0, off), force, 0}}, 0.5);
        for (Eigen::Index i = 0; i < block.nodes.rows(); ++i) {
            const bool here = (block.nodes.row(i).transpose() - node).norm() < 1e-9;
            // On a curved top the point above a node is not nearest to that node exactly.
            const double tolerance = GetParam() == Kind::curved && off > 0 ? 0.2 : 1e-12;
            EXPECT_LT((node_force(loads, i) - (here ? force : Vec3::Zero().eval())).norm(), tolerance * force.norm());
        }
    }
}

TEST_P(PatchLoad, OffTheSurfaceByMoreThanRadiusTakesTheNearestPoint) {
    const auto loads = patch_loads(block, {{{9, 9, 11}, Vec3::UnitZ(), 0.5}}, 1.0);
    const double height = mean_over_patch(block, loads, [](const Vec3& x) { return x.z(); });
    const double across = mean_over_patch(block, loads, [](const Vec3& x) { return x.x(); });
    const double bow = GetParam() == Kind::curved ? 0.2 : 0;
    EXPECT_NEAR(height, 10, 1e-9 + bow);
    EXPECT_NEAR(across, 9, 1e-9 + bow);
}

TEST(PatchLoadInput, ContactsOffTheBodyAreNamed) {
    const auto block = jittered_bar(Kind::linear, {size, size, 10}, {5, 5, 2});
    const auto complaint = [&](const mesh::Contact& contact) {
        return message_of<InvalidInput>([&] { patch_loads(block, {contact}, 0.5); });
    };
    const std::string far = complaint({{5, 5, 14}, Vec3::UnitZ(), 2});
    EXPECT_THAT(far, HasSubstr("The contact at (5, 5, 14) mm lies 4 mm off the surface"));
    EXPECT_THAT(far, HasSubstr("nearest surface point is (5, 5, 10)"));
    EXPECT_THAT(complaint({{5, 5, 10}, Vec3::UnitZ(), -1}), HasSubstr("radius -1 mm"));
    EXPECT_THAT(complaint({{5, 5, std::nan("")}, Vec3::UnitZ(), 1}), HasSubstr("(5, 5, nan)"));
}

}  // namespace
}  // namespace palpate::fem
