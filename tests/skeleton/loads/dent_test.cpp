#include "skeleton/loads/dent.h"

#include <gtest/gtest.h>

#include "tests/skeleton/test_models.h"

namespace palpate::skeleton {
namespace {

// A push down and along on a patch of one point, of radius 3 mm.
Load press() {
    Load load;
    load.patch_forces.push_back({{0.2, 0, -0.5}, Vec3::UnitZ(), 3, {{Vec3(1, 2, 3), 1.0}}});
    return load;
}

Vec3 motion(const Vec3& at, const Eigen::Matrix<double, 6, 1>& dent) {
    Model model = testing::make_chain(1);
    model.dent = dent;
    return dents(model, press(), at.transpose()).row(0);
}

TEST(Dent, FollowsTheForceWhereItPresses) {
    Eigen::Matrix<double, 6, 1> dent = Eigen::Matrix<double, 6, 1>::Zero();
    dent[0] = 2;  // normal, as far as the patch: 2 f / (0.3 r) in its middle
    EXPECT_LT((motion({1, 2, 3}, dent) - Vec3(0, 0, -0.5) * 2 / 0.9).norm(), 1e-12);
    dent.setZero();
    dent[5] = 2;  // across, as far as four radii
    EXPECT_LT((motion({1, 2, 3}, dent) - Vec3(0.2, 0, 0) * 2 / 0.9).norm(), 1e-12);
}

TEST(Dent, EndsAtItsReach) {
    Eigen::Matrix<double, 6, 1> dent = Eigen::Matrix<double, 6, 1>::Ones();
    EXPECT_TRUE(motion({13.1, 2, 3}, dent).isZero(0));
    EXPECT_FALSE(motion({12.9, 2, 3}, dent).isZero(0));
    dent.tail<4>().setZero();
    EXPECT_TRUE(motion({4.1, 2, 3}, dent).isZero(0));
}

TEST(Dent, FallsAwayFromThePatchWithoutAJump) {
    const Eigen::Matrix<double, 6, 1> dent = Eigen::Matrix<double, 6, 1>::Ones();
    double last = motion({1, 2, 3}, dent).norm();
    for (double d = 0.05; d < 12.5; d += 0.05) {
        const double now = motion({1 + d, 2, 3}, dent).norm();
        EXPECT_LT(now, last + 1e-15);
        EXPECT_GT(now, last - 0.2);
        last = now;
    }
}

}  // namespace
}  // namespace palpate::skeleton
