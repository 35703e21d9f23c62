#include "fem/interpolation/refine.h"

#include "fem/elements/shape.h"
#include "tests/fem/bodies.h"

namespace palpate::fem {
namespace {

class Refine : public testing::TestWithParam<Kind> {
protected:
    const mesh::VolumeMesh bar_ = jittered_bar(GetParam(), Vec3(3, 2, 2), {3, 2, 2});
    const RefinedMesh refined_ = refine(bar_);
};

INSTANTIATE_TEST_SUITE_P(QuadraticElements, Refine, testing::Values(Kind::quadratic, Kind::curved));

TEST_P(Refine, CutsEachElementIntoEightThatFit) {
    const mesh::VolumeMesh& fine = refined_.mesh;
    EXPECT_EQ(fine.tetrahedra.rows(), 8 * bar_.tetrahedra.rows());
    EXPECT_GT(mesh::element_volumes(fine).minCoeff(), 0);
    // Pieces that did not share their sides' nodes would leave boundary faces within the body.
    EXPECT_EQ(fine.faces.rows(), 4 * bar_.faces.rows());
    EXPECT_EQ(fine.nodes.rows(), refined_.interpolation.rows());
    EXPECT_EQ(fine.nodes.topRows(bar_.nodes.rows()), bar_.nodes);
}

TEST_P(Refine, KeepsItsShape) {
    // The volume of quadratic elements, by their own map and nodes: that of a refined body differs by rounding alone.
    const auto volume = [](const mesh::VolumeMesh& mesh) {
        double sum = 0;
        for (const auto& element : mesh.tetrahedra.rowwise()) {
            const auto X = node_positions<10>(mesh.nodes, element);
            for (const auto& [l, weight] : quadrature_5())
                sum += weight / 6 * (X.transpose() * shape_gradient<4, 10>(l)).determinant();
        }
        return sum;
    };
    EXPECT_NEAR(volume(refined_.mesh), volume(bar_), 1e-12 * volume(bar_));
}

TEST(RefineStraight, InterpolatesQuadraticFieldsExactly) {
    const mesh::VolumeMesh bar = jittered_bar(Kind::quadratic, Vec3(3, 2, 2), {3, 2, 2});
    const RefinedMesh refined = refine(bar);
    const auto field = [](const Points& x) {
        return Eigen::VectorXd(x.col(0).array().square() - 2 * x.col(1).array() * x.col(2).array() + x.col(2).array());
    };
    // Rounding.
    EXPECT_LT((refined.interpolation * field(bar.nodes) - field(refined.mesh.nodes)).cwiseAbs().maxCoeff(), 1e-12);
}

}  // namespace
}  // namespace palpate::fem
