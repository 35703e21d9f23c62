#include "skeleton/model/attachment/carried_point.h"

#include <gtest/gtest.h>

#include <numbers>

#include "skeleton/model/observation.h"
#include "tests/skeleton/test_models.h"

namespace palpate::skeleton {
namespace {

using testing::make_chain;
using testing::make_lattice;
using testing::random_state;
using testing::random_vector;

// A point on several spheres that follows what they move against one another in no simple way.
Attachment random_attachment(const Model& model, std::mt19937_64& engine) {
    const std::vector<int> spheres{1, 4, 6, 9};
    const std::vector<double> weights{0.4, 0.3, 0.25, 0.05};
    Attachment point{{}, model.spheres[4].center + Vec3(3, -2, 4)};
    Eigen::Matrix<double, 3, 24> follow = Eigen::Matrix<double, 3, 24>::Zero(), random;
    Eigen::Matrix<double, 24, 6> rigid;
    for (int c = 0; c < 24; ++c) random.col(c) = random_vector(engine, c % 6 < 3 ? 0.3 : 3);
    for (int i = 0; i < 4; ++i) {
        const Vec3& X = model.spheres[spheres[i]].center;
        follow.middleCols<6>(6 * i) << weights[i] * Mat3::Identity(), -weights[i] * skew(point.rest - X);
        rigid.middleRows<6>(6 * i).setIdentity();
        rigid.block<3, 3>(6 * i, 3) = -skew(X);
    }
    // less what of it a rigid motion would see
    const Eigen::Matrix<double, 6, 24> onto = (rigid.transpose() * rigid).inverse() * rigid.transpose();
    follow += random - random * rigid * onto;
    for (int i = 0; i < 4; ++i) point.shares.push_back({spheres[i], weights[i], follow.middleCols<6>(6 * i)});
    return point;
}

TEST(CarriedPoint, AtRestItMovesAsToldToFirstOrder) {
    const Model model = make_lattice({3, 2, 2});
    std::mt19937_64 engine(1);
    const Attachment point = random_attachment(model, engine);
    const State rest = rest_state(model);
    const CarriedPoint carried(point, rest, rest);
    EXPECT_LT((carried.x() - point.rest).norm(), 1e-13);
    for (int i = 0; i < carried.shares(); ++i) EXPECT_LT((carried.jacobian(i) - point.shares[i].follow).norm(), 1e-12);
}

TEST(CarriedPoint, RigidMotionsAreFollowedExactly) {
    const Model model = make_lattice({3, 2, 2});
    std::mt19937_64 engine(2);
    const Attachment point = random_attachment(model, engine);
    const Mat3 R = rotation({1.0, -2.0, 0.5});
    State moved = rest_state(model);
    for (Eigen::Index i = 0; i < moved.x.rows(); ++i) {
        moved.x.row(i) = (R * moved.x.row(i).transpose() + Vec3(5, 6, 7)).transpose();
        moved.R[i] = R;
    }
    EXPECT_LT((CarriedPoint(point, rest_state(model), moved).x() - R * point.rest - Vec3(5, 6, 7)).norm(), 1e-12);
}

TEST(CarriedPoint, TurnsAlongWithAMotionOfTheWhole) {
    const Model model = make_lattice({3, 2, 2});
    std::mt19937_64 engine(3);
    const Attachment point = random_attachment(model, engine);
    const State rest = rest_state(model), bent = random_state(model, engine, 2, 0.5);
    const Mat3 R = rotation({-0.7, 1.9, 0.3});
    State moved = bent;
    for (Eigen::Index i = 0; i < moved.x.rows(); ++i) {
        moved.x.row(i) = (R * bent.x.row(i).transpose()).transpose();
        moved.R[i] = R * bent.R[i];
    }
    EXPECT_LT((CarriedPoint(point, rest, moved).x() - R * CarriedPoint(point, rest, bent).x()).norm(), 1e-12);
}

TEST(CarriedPoint, JacobianAndCurvatureAreDerivatives) {
    const Model model = make_lattice({3, 2, 2});
    std::mt19937_64 engine(4);
    const State rest = rest_state(model);
    for (int repeat = 0; repeat < 5; ++repeat) {
        const Attachment point = random_attachment(model, engine);
        const State state = random_state(model, engine, 3, 0.6);
        const Vec3 f = random_vector(engine, 1);
        const CarriedPoint carried(point, rest, state);
        const Eigen::MatrixXd H = carried.curvature(f);
        EXPECT_LT((H - H.transpose()).norm(), 1e-11 * H.norm());
        Eigen::VectorXd along = Eigen::VectorXd::Zero(model.dofs()), own(24);
        for (int i = 0; i < 4; ++i) {
            own.segment<6>(6 * i) << random_vector(engine, 1), random_vector(engine, 0.3);
            along.segment<6>(6 * carried.sphere(i)) = own.segment<6>(6 * i);
        }
        double slope = 0;
        for (int i = 0; i < 4; ++i) slope += f.dot(carried.jacobian(i) * own.segment<6>(6 * i));
        const double h = 1e-3;
        const auto value = [&](double t) {
            return f.dot(CarriedPoint(point, rest, advance(state, t * h * along)).x());
        };
        EXPECT_NEAR((8 * (value(1) - value(-1)) - value(2) + value(-2)) / (12 * h), slope,
                    1e-8 * (1 + std::abs(slope)));
        const double second = (-value(2) + 16 * value(1) - 30 * value(0) + 16 * value(-1) - value(-2)) / (12 * h * h);
        EXPECT_NEAR(own.dot(H * own), second, 1e-5 * (1 + std::abs(second)));
    }
}

// Twisted by a quarter turn between two spheres the skin half way turns by half of it, and keeps its distance.
TEST(CarriedPoint, ATwistDoesNotPullTheSkinIn) {
    const Model model = make_chain(1);
    const Attachment point = between(model, 0, 1, 0.5, {5, 3, 0});
    State twisted = rest_state(model);
    twisted.R[1] = rotation(std::numbers::pi / 2 * Vec3::UnitX());
    const Vec3 x = CarriedPoint(point, rest_state(model), twisted).x();
    EXPECT_NEAR(x.tail<2>().norm(), 3, 1e-12);
    EXPECT_NEAR(std::atan2(x.z(), x.y()), std::numbers::pi / 4, 1e-12);
}

TEST(Blend, MovesAsTheMeanOfItsPartsToFirstOrder) {
    const Model model = make_lattice({3, 2, 2});
    std::mt19937_64 engine(5);
    const Attachment one = random_attachment(model, engine), two = between(model, 4, 5, 0.3, {12, 3, 4});
    const std::vector<std::pair<double, const Attachment*>> parts{{0.3, &one}, {0.7, &two}};
    const Attachment mean = blend(parts);
    const Eigen::MatrixXd P = observation_jacobian(model, rest_state(model), {one, two, mean});
    EXPECT_LT((0.3 * P.topRows<3>() + 0.7 * P.middleRows<3>(3) - P.bottomRows<3>()).norm(), 1e-12);
}

}  // namespace
}  // namespace palpate::skeleton
