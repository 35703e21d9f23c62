#include "identify/diagnosis/locate/residual.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "tests/identify/diagnosed.h"

namespace palpate::identify {
namespace {

constexpr double degrees = M_PI / 180;

class ResidualOfABar : public Diagnosed {
protected:
    Diagnosis left_by(const Explanation& hidden, std::vector<skeleton::EffectRecord> known = {}) const {
        DiagnoseOptions options;
        options.law = neo_hookean;
        options.refit.nuisances.ragged = 0;
        options.screen = false;
        options.known = std::move(known);
        return diagnose(make_twin(*model_, body_.set(SmallBody::probes(0.03)), hidden, sigma), options);
    }
    static Vec3 vector_at(const skeleton::EffectRecord& effect, std::size_t first) {
        return {effect.parameters[first].value, effect.parameters[first + 1].value, effect.parameters[first + 2].value};
    }
    const Vec3 at_ = Vec3(32, 5, 5), pull_ = Vec3(0, 0.006, -0.008);  // [mm], [N]; the bar is 40 mm long
    const Eigen::VectorXd force_ = numbers({at_.x(), at_.y(), at_.z(), std::log(4), pull_.x(), pull_.y(), pull_.z()});
};

TEST_F(ResidualOfABar, IsAForceThatPullsAsTheHiddenOneDoes) {
    const auto residual = find_residual(*model_, left_by(truth("local-force", force_)), {});
    ASSERT_TRUE(residual);
    EXPECT_EQ(residual->effect.name, "local-force");
    EXPECT_GT(residual->log_bayes_factor, DiagnoseOptions{}.least_evidence());
    // A slender bar tells one place from another by how it bends alone: that is left to the fit.
    EXPECT_LT(std::acos(vector_at(residual->effect, 4).normalized().dot(pull_.normalized())), 20 * degrees);
}

TEST_F(ResidualOfABar, FittedFromThereIsWhereTheHiddenOneIs) {
    const Explanation hidden = truth("local-force", force_);
    const Diagnosis without = left_by(hidden);
    const auto residual = find_residual(*model_, without, {});
    ASSERT_TRUE(residual);
    const Refit& fit = left_by(hidden, {residual->effect}).baseline;
    EXPECT_GT(without.baseline.whitened_rms, 5);
    EXPECT_LT(fit.whitened_rms, 1.1);
    const skeleton::EffectRecord found = fit.explanation.effects[0]->record(fit.numbers[0], fit.explanation.values[0]);
    EXPECT_LT((vector_at(found, 0) - at_).norm(), 0.05 * model_->size());
    // Along the bar a force hardly shows.
    EXPECT_LT((vector_at(found, 4) - pull_).tail<2>().norm(), 0.15 * pull_.norm());
}

TEST_F(ResidualOfABar, FarStrongerThanTheProbesIsFound) {
    // The probes move the bar by a millimetre, the force by ten: the fit without it is as stiff as its prior lets it
    // be.
    Eigen::VectorXd strong = force_;
    strong.tail<3>() *= 5;
    const Diagnosis without = left_by(truth("local-force", strong));
    const auto residual = find_residual(*model_, without, {});
    ASSERT_TRUE(residual);
    EXPECT_EQ(residual->effect.name, "local-force");
    const Refit beside = beside_constant_sources(*model_, without.problem, without.baseline, {});
    const auto off = [&](const Explanation& e) {
        return std::abs(std::log(model_->young(e.setting()) / model_->young(truth().setting())));
    };
    EXPECT_LT(off(beside.explanation), 0.7 * off(without.baseline.explanation));
    const Refit& fit = left_by(truth("local-force", strong), {residual->effect}).baseline;
    EXPECT_LT(fit.whitened_rms, 1.1);
}

TEST_F(ResidualOfABar, IsSpringsWhereTheSkinIsHeld) {
    const Eigen::VectorXd held = numbers({38, 5, 9, std::log(3), std::log(0.02)});
    const auto residual = find_residual(*model_, left_by(truth("local-springs", held)), {});
    ASSERT_TRUE(residual);
    EXPECT_EQ(residual->effect.name, "local-springs");
    EXPECT_LT((vector_at(residual->effect, 0) - held.head<3>()).norm(), 0.3 * model_->size());
    EXPECT_GT(residual->effect.parameters[4].value, 0);
}

TEST_F(ResidualOfABar, IsGrowthWhereThatMaterialSwells) {
    const Eigen::VectorXd swollen = numbers({24, 7, 3, std::log(4), 0.1});
    const Explanation hidden = truth("local-swelling", swollen);
    const Diagnosis without = left_by(hidden);
    const auto residual = find_residual(*model_, without, {});
    ASSERT_TRUE(residual);
    EXPECT_EQ(residual->effect.name, "local-swelling");
    const Refit& fit = left_by(hidden, {residual->effect}).baseline;
    EXPECT_LT(fit.whitened_rms, 1.1);
    const skeleton::EffectRecord found = fit.explanation.effects[0]->record(fit.numbers[0], fit.explanation.values[0]);
    EXPECT_LT((vector_at(found, 0) - swollen.head<3>()).norm(), 0.1 * model_->size());
    EXPECT_GT(found.parameters[4].value, 0);
}

TEST_F(ResidualOfABar, IsNoneWhereNothingIsLeft) {
    const auto residual = find_residual(*model_, left_by(truth()), {});
    // Where nothing is missing a Bayes factor is 1 on average.
    EXPECT_LT(residual ? residual->log_bayes_factor : 0, DiagnoseOptions{}.least_evidence());
}

}  // namespace
}  // namespace palpate::identify
