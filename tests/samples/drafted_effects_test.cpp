// Drafts of 'improve --draft' as they were written (tests/pipeline/output/text/drafts), compiled: they are in the
// catalogue, and act as what they were drafted from.

#include <gtest/gtest.h>

#include "identify/effects/catalogue.h"

namespace palpate::identify {
namespace {

const std::vector<skeleton::EffectParameter> place{
    {"cx", 29.381, "mm"}, {"cy", -1.9754, "mm"}, {"cz", -2.828, "mm"}, {"radius", 9.28, "mm"}};

/// Do both pull some points alike?
void expect_alike(const skeleton::EffectRecord& drafted, skeleton::EffectRecord located) {
    located.parameters.insert(located.parameters.begin(), place.begin(), place.end());
    const auto own = skeleton::make_physics(drafted).points.front();
    const auto other = skeleton::make_physics(located).points.front();
    EXPECT_EQ(own->acts_on(), other->acts_on());
    Points rest(3, 3);
    rest << 30, 0, 0, 20, 5, -8, 45, -2, 3;
    EXPECT_LT((own->weights(rest, Eigen::Vector3d(1, 2, 1)) - other->weights(rest, Eigen::Vector3d(1, 2, 1))).norm(),
              1e-15);
    const Vec3 X(30, 0, 0), x(30.5, 1, -2);
    EXPECT_DOUBLE_EQ(own->terms(X, x).energy, other->terms(X, x).energy);
    EXPECT_EQ(own->terms(X, x).gradient, other->terms(X, x).gradient);
    EXPECT_EQ(own->terms(X, x).hessian, other->terms(X, x).hessian);
}

TEST(DraftedEffect, ActsAsTheForceThatWasLocated) {
    const std::vector<skeleton::EffectParameter> force{{"fx", -0.03, "N"}, {"fy", 0, "N"}, {"fz", 0.04, "N"}};
    expect_alike({"pull", force}, {"local-force", force});
}

TEST(DraftedEffect, ActsAsTheSpringsThatWereLocated) {
    const std::vector<skeleton::EffectParameter> stiffness{{"stiffness", 0.055, "N/mm"}};
    expect_alike({"ligament", stiffness}, {"local-springs", stiffness});
}

TEST(DraftedEffect, GrowsAsThePartThatWasLocated) {
    const std::vector<skeleton::EffectParameter> growth{{"growth", -0.08, "1"}};
    skeleton::EffectRecord located{"local-swelling", place};
    located.parameters.insert(located.parameters.end(), growth.begin(), growth.end());
    const fem::Growth own = skeleton::make_physics({"dry-spot", growth}).growth;
    for (const Vec3& X : {Vec3(30, 0, 0), Vec3(45, -2, 3)})
        EXPECT_EQ(own.at(X), skeleton::make_physics(located).growth.at(X));
    EXPECT_LT(own.at({30, 0, 0}), -0.07);
}

TEST(DraftedEffect, IsLookedForByADiagnosis) {
    for (const char* name : {"pull", "ligament", "dry-spot"}) {
        const auto effect = effect_named(name);
        ASSERT_TRUE(effect) << name;
        EXPECT_NE(std::ranges::find(catalogue(), effect), catalogue().end()) << name;
        EXPECT_TRUE(effect->sentence({name, {{"fx", 1, "N"}, {"fy", 2, "N"}, {"fz", 3, "N"}}}).ends_with('.'));
    }
}

}  // namespace
}  // namespace palpate::identify
