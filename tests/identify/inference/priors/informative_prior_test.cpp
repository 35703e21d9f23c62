#include "identify/inference/priors/informative_prior.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "identify/inference/priors/log_normal_prior.h"
#include "identify/inference/problem/identify_options.h"
#include "identify/inference/problem/inform.h"
#include "identify/inference/problem/parameters.h"
#include "identify/models/skeleton/skeleton_body.h"
#include "tests/identify/lattice.h"
#include "tests/messages.h"

namespace palpate::identify {
namespace {

TEST(InformativePrior, IsOfTheStiffnessNotOfItsMultiplier) {
    const Parameters uniform = group_stiffness(make_lattice({4, 2, 1}, 3), Scope::uniform);
    LogNormalPrior prior{Eigen::Vector3d::Zero(), Eigen::Vector3d::Constant(wide_sd), nullptr};
    const double flexion = uniform.list[1].stiffness;
    const auto informed = inform(
        prior, uniform, {{"flexion", std::log(3 * flexion), 0.2}, {"torsion", 0, 2 * wide_sd}, {"young", 0, 0.1}});
    EXPECT_THAT(informed, testing::ElementsAre("flexion"));
    EXPECT_NEAR(prior.mean[1], std::log(3.0), 1e-12);
    EXPECT_EQ(prior.sd[1], 0.2);
    EXPECT_EQ(prior.mean[0], 0);
    EXPECT_EQ(prior.sd[2], wide_sd);
}

TEST(InformativePrior, OfASkeletonThatJudgesIsTheSame) {
    const skeleton::Model model = make_lattice({4, 2, 1}, 3);
    const double flexion = group_stiffness(model, Scope::uniform).list[1].stiffness;
    const SkeletonBody body(model, {}, 0.1, {}, wide_sd, {{"flexion", std::log(3 * flexion), 0.2}});
    for (const StiffnessParameter& parameter : body.parameters()) {
        const bool told = parameter.name == "flexion";
        EXPECT_NEAR(parameter.prior_mean, told ? std::log(3.0) : 0, 1e-12) << parameter.name;
        EXPECT_EQ(parameter.prior_sd, told ? 0.2 : wide_sd) << parameter.name;
    }
}

TEST(InformativePrior, IsNoneOfThePrintedAlgorithms) {
    IdentifyOptions options;
    options.method = Method::burion2008;
    options.priors = {{"flexion", 0, 1}};
    EXPECT_THAT(message_of([&] { options.validate(); }), testing::HasSubstr("use the method 'tempered'"));
}

}  // namespace
}  // namespace palpate::identify
