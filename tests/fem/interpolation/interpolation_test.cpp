#include "fem/interpolation/interpolation.h"

#include "tests/fem/bodies.h"

namespace palpate::fem {
namespace {

const Vec3 extent(3, 2, 2);

Points random_points(int count, const Vec3& min, const Vec3& max) {
    std::mt19937 engine(3);
    Points points(count, 3);
    for (int a = 0; a < 3; ++a) {
        std::uniform_real_distribution<double> draw(min(a), max(a));
        for (int i = 0; i < count; ++i) points(i, a) = draw(engine);
    }
    return points;
}

class Interpolation : public testing::TestWithParam<Kind> {
protected:
    const mesh::VolumeMesh bar = jittered_bar(GetParam(), extent, {6, 4, 4});
};

INSTANTIATE_TEST_SUITE_P(AllElements, Interpolation, testing::Values(Kind::linear, Kind::quadratic, Kind::curved));

TEST_P(Interpolation, ReproducesPositions) {
    const Points points = random_points(500, Vec3::Zero(), extent);
    const auto N = interpolation(bar, points);
    // A linear field, so exact in every element; near a bowed surface too, where it is continued outwards. Rounding.
    EXPECT_LT((N * bar.nodes - points).cwiseAbs().maxCoeff(), 1e-11);
}

TEST_P(Interpolation, WeightsAddUpToOne) {
    const auto N = interpolation(bar, random_points(200, Vec3::Constant(-1), extent + Vec3::Ones()));
    const Eigen::VectorXd sums = N * Eigen::VectorXd::Ones(bar.nodes.rows());
    // Rounding.
    EXPECT_LT((sums.array() - 1).abs().maxCoeff(), 1e-12);
}

TEST_P(Interpolation, IsExactAtTheNodes) {
    const auto N = interpolation(bar, bar.nodes);
    EXPECT_LT((N * bar.nodes - bar.nodes).cwiseAbs().maxCoeff(), 1e-11);
}

TEST_P(Interpolation, FarOutsideTakesTheNearestPoint) {
    if (GetParam() == Kind::curved) return;  // where the nearest point of a bowed surface is not known
    Points points(3, 3);
    points << 5, 1.1, 0.9, -4, -4, -4, 1.3, 0.7, 9;
    Points nearest(3, 3);
    nearest << 3, 1.1, 0.9, 0, 0, 0, 1.3, 0.7, 2;
    EXPECT_LT((interpolation(bar, points) * bar.nodes - nearest).cwiseAbs().maxCoeff(), 1e-11);
}

TEST(QuadraticInterpolation, ReproducesQuadraticFieldsInsideAndCloseBy) {
    const auto bar = jittered_bar(Kind::quadratic, extent, {6, 4, 4});
    const auto field = [](const auto& x) { return 1 + 2 * x(0) - x(2) + x(0) * x(1) - 3 * x(2) * x(2) + x(1) * x(1); };
    Eigen::VectorXd nodal_values(bar.nodes.rows());
    for (Eigen::Index i = 0; i < bar.nodes.rows(); ++i) nodal_values(i) = field(bar.nodes.row(i));
    // 0.1 outside is less than half an edge: there the element's own polynomial goes on.
    const Points points = random_points(500, Vec3::Constant(-0.1), extent + Vec3::Constant(0.1));
    const Eigen::VectorXd values = interpolation(bar, points) * nodal_values;
    for (Eigen::Index i = 0; i < points.rows(); ++i) EXPECT_NEAR(values(i), field(points.row(i)), 1e-11);
}

}  // namespace
}  // namespace palpate::fem
