#include "skeleton/model/state.h"

#include <gtest/gtest.h>

#include <numbers>

#include "skeleton/model/observation.h"
#include "tests/skeleton/test_models.h"

namespace palpate::skeleton {
namespace {

using testing::make_chain;
using testing::random_state;
using testing::random_vector;

TEST(Rotation, IsOrthogonalAndTurnsAboutItsVector) {
    std::mt19937_64 engine(1);
    for (const double size : {0.0, 1e-12, 1e-6, 0.1, 1.0, 3.0}) {
        const Vec3 w = random_vector(engine, size);
        const Mat3 R = rotation(w);
        // Rounding of a few operations on numbers of size 1.
        EXPECT_LT((R * R.transpose() - Mat3::Identity()).norm(), 1e-14);
        EXPECT_NEAR(R.determinant(), 1, 1e-14);
        EXPECT_LT((R * w - w).norm(), 1e-14);
        EXPECT_NEAR(R.trace(), 1 + 2 * std::cos(w.norm()), 1e-14);
    }
}

TEST(Rotation, SmallOnesAreOnePlusSkew) {
    const Vec3 w(1e-5, -2e-5, 3e-5);
    // The second order is |w|^2 / 2 = 7e-10.
    EXPECT_LT((rotation(w) - Mat3::Identity() - skew(w)).norm(), 1.5e-9);
    EXPECT_LT((rotation(w) - Mat3::Identity() - skew(w) - 0.5 * skew(w) * skew(w)).norm(), 1e-13);
}

TEST(Rotation, VectorIsItsInverse) {
    std::mt19937_64 engine(2);
    for (const double angle : {0.0, 1e-10, 1e-4, 0.5, 2.0, 3.1, std::numbers::pi - 1e-6}) {
        const Vec3 w = angle * random_vector(engine, 1).normalized();
        // Rounding, also close to pi.
        EXPECT_LT((rotation_vector(rotation(w)) - w).norm(), 1e-12) << angle;
    }
}

TEST(Observe, RestIsWhereThePointsAre) {
    const Model model = make_chain(3);
    const std::vector<Attachment> points{between(model, 0, 1, 0.3, {3, 4, 1}), between(model, 2, 2, 0.7, {19, -4, 2}),
                                         between(model, 2, 3, 1.0, {31, 0, 5})};
    const Points seen = observe(model, rest_state(model), points);
    for (int i = 0; i < 3; ++i) EXPECT_LT((seen.row(i).transpose() - points[i].rest).norm(), 1e-14);
}

TEST(Observe, RigidMotionCarriesEveryPointAlong) {
    const Model model = make_chain(3);
    const std::vector<Attachment> points{between(model, 0, 1, 0.3, {3, 4, 1}), on_sphere(model, 1, {9, -4, 2}),
                                         between(model, 2, 3, 0.9, {31, 0, 5})};
    const Mat3 R = rotation({1.0, -2.0, 0.5});
    const Vec3 shift(5, 6, 7);
    State moved = rest_state(model);
    for (size_t i = 0; i < model.spheres.size(); ++i) {
        moved.x.row(i) = (R * model.spheres[i].center + shift).transpose();
        moved.R[i] = R;
    }
    const Points seen = observe(model, moved, points);
    // Rounding of coordinates of some 30 mm.
    for (int i = 0; i < 3; ++i) EXPECT_LT((seen.row(i).transpose() - R * points[i].rest - shift).norm(), 1e-12);
}

TEST(Observe, JacobianIsItsDerivative) {
    const Model model = make_chain(3);
    const std::vector<Attachment> points{between(model, 0, 1, 0.3, {3, 4, 1}), on_sphere(model, 1, {9, -4, 2}),
                                         between(model, 2, 3, 0.9, {31, 0, 5})};
    std::mt19937_64 engine(3);
    const State state = random_state(model, engine, 5, 1);
    const Eigen::MatrixXd P = observation_jacobian(model, state, points);
    const double h = 1e-6;
    for (int j = 0; j < model.dofs(); ++j) {
        const Eigen::VectorXd step = h * Eigen::VectorXd::Unit(model.dofs(), j);
        const Points difference =
            observe(model, advance(state, step), points) - observe(model, advance(state, -step), points);
        const Eigen::Map<const Eigen::VectorXd> flat(difference.data(), difference.size());
        // Central differences: arm h^2 / 6 = 2e-12, and rounding of 30 mm / h = 5e-9.
        EXPECT_LT((flat / (2 * h) - P.col(j)).norm(), 1e-7) << j;
    }
}

}  // namespace
}  // namespace palpate::skeleton
