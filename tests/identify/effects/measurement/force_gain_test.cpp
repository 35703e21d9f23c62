#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "identify/diagnosis/problem.h"
#include "identify/effects/catalogue.h"
#include "identify/models/skeleton/skeleton_body.h"
#include "tests/identify/lattice.h"

namespace palpate::identify {
namespace {

using testing::HasSubstr;

/// Six probes, each with twice the load of the one before.
Problem doubling_loads() {
    Problem problem;
    for (int k = 0; k < 6; ++k) {
        problem.actions.push_back(
            {.contacts = {{.point = Vec3(10 * k, 0, 0), .force = Vec3(0, 0, -std::pow(2.0, k)), .radius = 1}}});
        problem.probe.push_back(k + 1);
    }
    return problem;
}

TEST(ForceGain, IsObjectedToWhereTheBodyStiffens) {
    // effective force F^0.8: gains that fall with the load in one line
    const Eigen::VectorXd falling = -0.2 * std::log(2.0) * Eigen::VectorXd::LinSpaced(6, 0, 5);
    EXPECT_THAT(find_effect("force-gain")->objection(doubling_loads(), falling), HasSubstr("stiffens"));
}

TEST(ForceGain, IsAClaimWhereGainsComeAndGo) {
    Eigen::VectorXd alternating(6);
    alternating << 0.2, -0.2, 0.2, -0.2, 0.2, -0.2;
    EXPECT_EQ(find_effect("force-gain")->objection(doubling_loads(), alternating), "");
}

TEST(ForceGain, LoadsAlongOneLineShareOneUnlessOneIsRepeated) {
    Problem curve = doubling_loads();
    for (Action& action : curve.actions) action.contacts.front().point.setZero();
    const EffectHypothesis& gain = *find_effect("force-gain");
    const SkeletonBody body(make_lattice({2, 1, 1}), {}, 1);
    EXPECT_TRUE(gain.numbers(body, curve).empty());  // one gain is a stiffness
    curve.actions.push_back(curve.actions[2]);
    curve.probe.push_back(9);
    const auto numbers = gain.numbers(body, curve);
    ASSERT_EQ(numbers.size(), 2U);
    EXPECT_EQ(numbers[0].name, "probe1");
    EXPECT_EQ(numbers[1].name, "probe9");
    Eigen::VectorXd values(2);
    values << std::log(1.5), std::log(0.5);
    for (int k = 0; k < 7; ++k)
        EXPECT_NEAR(gain.act(curve, k, curve.actions[k], values).contacts.front().force.z(),
                    (k < 6 ? 1.5 : 0.5) * curve.actions[k].contacts.front().force.z(), 1e-12);  // rounding
    // Along another line it is another way of loading.
    curve.actions[6].contacts.front().force = Vec3(1, 0, 0);
    EXPECT_EQ(gain.numbers(body, curve).size(), 2U);
}

}  // namespace
}  // namespace palpate::identify
