#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "identify/effects/catalogue.h"
#include "identify/models/skeleton/skeleton_body.h"
#include "tests/identify/lattice.h"
#include "tests/identify/small_body.h"

namespace palpate::identify {
namespace {

using testing::HasSubstr;

TEST(Inclusion, HasAWidthAcrossASheet) {
    const SkeletonBody sheet(make_lattice({3, 3, 1}), {}, 1);
    for (const EffectNumber& number : find_effect("inclusion")->numbers(sheet, {})) {
        EXPECT_GT(number.prior_sd, 0) << number.name;
    }
}

TEST(InclusionEffect, IsNoBallLargerThanTheBody) {
    const SmallBody body;  // of 40 mm
    const auto inclusion = find_effect("inclusion");
    Problem problem = make_problem(body.set(SmallBody::probes()), 1);
    const auto objection = [&](double radius) {
        Eigen::VectorXd values(5);
        values << 20, 5, 5, std::log(radius), 0.5;
        return inclusion->objection(problem, values);
    };
    EXPECT_EQ(objection(15), "");
    EXPECT_THAT(objection(30), HasSubstr("of radius 30 mm, is larger than the body"));
    problem.markers = 0;  // forces alone were read
    EXPECT_EQ(objection(30), "");
}

TEST(Catalogue, AnInclusionSaysWhereItsRadiusAndStiffnessAreKnownTogetherOnly) {
    const skeleton::EffectRecord ball{
        "inclusion", {{"cx", 1, "mm"}, {"cy", 2, "mm"}, {"cz", 3, "mm"}, {"radius", 6, "mm"}, {"ratio", 4, "1"}}};
    Eigen::MatrixXd covariance = Eigen::VectorXd::Ones(5).asDiagonal();
    const auto sentence = [&] { return find_effect("inclusion")->sentence_with(ball, covariance); };
    EXPECT_THAT(sentence(), testing::Not(HasSubstr("together")));
    covariance(3, 4) = covariance(4, 3) = -0.95;
    EXPECT_THAT(sentence(), HasSubstr("its radius and its stiffness are known together only."));
}

}  // namespace
}  // namespace palpate::identify
