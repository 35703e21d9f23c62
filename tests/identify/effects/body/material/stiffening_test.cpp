#include <gtest/gtest.h>

#include "identify/diagnosis/problem.h"
#include "identify/effects/catalogue.h"
#include "identify/models/skeleton/skeleton_body.h"
#include "tests/identify/lattice.h"

namespace palpate::identify {
namespace {

TEST(Stiffening, OfAHundredTimesTheUsualIsNoSurprise) {
    const auto effect = find_effect("stiffening");
    const SkeletonBody lattice(make_lattice({3, 3, 1}), {}, 1);
    const auto numbers = effect->numbers(lattice, {});
    const auto away = [&](double c2, double c3) -> Eigen::VectorXd {  // in prior standard deviations
        const skeleton::EffectRecord estimate{"stiffening", {{"c2", c2, "1"}, {"c3", c3, "1"}}};
        const Eigen::VectorXd values = effect->values(numbers, estimate);
        return Eigen::Vector2d((values[0] - numbers[0].prior_mean) / numbers[0].prior_sd,
                               (values[1] - numbers[1].prior_mean) / numbers[1].prior_sd)
            .cwiseAbs();
    };
    EXPECT_NEAR(away(3, 30)[0], 1, 0.05);
    EXPECT_LT(away(3, 12).maxCoeff(), 1.1);  // exponential laws
    EXPECT_LT(away(100, 4 / 3. * 1e4).maxCoeff(), 4);
    EXPECT_DOUBLE_EQ(away(0, 0).norm(), 0);
}

TEST(Stiffening, OfEitherCoefficientAloneComesBack) {
    const auto effect = find_effect("stiffening");
    const SkeletonBody lattice(make_lattice({3, 3, 1}), {}, 1);
    const auto numbers = effect->numbers(lattice, {});
    for (const auto& [c2, c3] : {std::pair{3.0, 0.0}, {0.0, 30.0}}) {
        const skeleton::EffectRecord estimate{"stiffening", {{"c2", c2, "1"}, {"c3", c3, "1"}}};
        const skeleton::EffectRecord back = effect->record(numbers, effect->values(numbers, estimate));
        EXPECT_NEAR(back.parameters[0].value, c2, 1e-6);
        EXPECT_NEAR(back.parameters[1].value, c3, 1e-6);
    }
}

}  // namespace
}  // namespace palpate::identify
