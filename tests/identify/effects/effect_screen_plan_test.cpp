#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "identify/diagnosis/search/screen_plan.h"
#include "identify/effects/catalogue.h"
#include "tests/identify/small_body.h"

// What an effect's screen asks of a model that lacks it, against plays with a little of the effect.

namespace palpate::identify {
namespace {

struct ScreenCase {
    std::string name;
    bool is_skeleton;
    int law;
};

class Screening : public testing::TestWithParam<ScreenCase> {
protected:
    Screening() {
        if (GetParam().is_skeleton) {
            model_ = body_.skeleton();
        } else {
            model_ = body_.reference();
        }
        bare_ = bare_truth(*model_, GetParam().law);
    }
    Problem problem(double force) const {
        MeasurementSet set = body_.set(SmallBody::probes(force, 4));
        set.material = MaterialGuess{.poisson = 0.45};
        return make_problem(make_twin(*model_, set, bare_, 0), 0.05);
    }
    ScreenColumns screened(const EffectHypothesis& effect, const Problem& all, const ForwardSolution& forward) const {
        const ScreenPlan plan = screen_plan(effect, *model_, all, bare_, forward);
        return plan.columns(sensitivities(*model_, all, bare_, forward, {plan.signatures}, 1).front());
    }
    /// What is seen of an effect, over sigma (N).
    Eigen::VectorXd seen(const Problem& all, const std::shared_ptr<const EffectHypothesis>& effect,
                         const Eigen::VectorXd& values, const ForwardSolution& near) const {
        return all.pick(solve_forward(*model_, all, with(bare_, effect, values), 1, &near.q).markers)
            .cwiseQuotient(all.sigma);
    }

    /// What springs of stiffness k move, over sigma and their compliance, against the screen's column.
    struct Compared {
        Eigen::VectorXd column, moved;
    };
    Compared compliant_support(double force, double k) const {
        const Problem all = problem(force);
        const ForwardSolution forward = solve_forward(*model_, all, bare_, 1);
        const auto effect = find_effect("compliant-support");
        const Eigen::VectorXd moved = seen(all, effect, Eigen::Vector2d(std::log(k), 0), forward) -
                                      all.pick(forward.markers).cwiseQuotient(all.sigma);
        return {screened(*effect, all, forward).columns.col(0), k * moved};
    }

    SmallBody body_;
    std::unique_ptr<BodyModel> model_;
    Explanation bare_;
};

TEST_P(Screening, OfACompliantSupportIsTheDerivativeByCompliance) {
    // The base moves as one where springs are soft against what they hold (E times 10 mm: 3 N/mm), and by little where
    // the load is a hair.
    const auto [column, moved] = compliant_support(1e-6, 0.03);
    EXPECT_LT((column - moved).norm(), 0.01 * moved.norm());  // their ratio, by a shape factor
}

TEST_P(Screening, OfACompliantSupportIsTheDerivativeAtNoneInLargeDeformation) {
    const auto [column, moved] = compliant_support(0.01, 1000);
    EXPECT_GT(moved.norm(), 1);
    if (GetParam().is_skeleton) {
        EXPECT_LT((column - moved).norm(), 0.01 * moved.norm());  // its base is one sphere: no approximation
    } else {
        // Next to springs as stiff as these the face deforms, which adds as much again of about the same shape.
        EXPECT_GT(column.normalized().dot(moved.normalized()), 0.94);
        EXPECT_NEAR(column.norm() / moved.norm(), 0.5, 0.1);
    }
}

TEST_P(Screening, OfEffectsThatAreNeutralAtTheirStartIsTheDerivativeThere) {
    const Problem all = problem(0.01);
    const ForwardSolution forward = solve_forward(*model_, all, bare_, 1);
    // neutral at no compliance, at no fibres, ...: none of which is a number to start with
    const std::set<std::string> with_alternatives{"compliant-support", "anisotropy", "inclusion", "contact",
                                                  "viscosity",         "plasticity", "damage",    "stiffening"};
    int tested = 0;
    for (const auto& effect : catalogue()) {
        const auto numbers = effect->numbers(*model_, all);
        if (numbers.empty() || with_alternatives.contains(effect->name())) continue;
        ++tested;
        const ScreenColumns found = screened(*effect, all, forward);
        ASSERT_EQ(found.columns.cols(), std::ssize(numbers));
        EXPECT_EQ(found.alternatives(), 1);
        Eigen::VectorXd start(std::ssize(numbers));
        for (Eigen::Index j = 0; j < start.size(); ++j) start[j] = numbers[j].start;
        for (Eigen::Index j = 0; j < start.size(); ++j) {
            EXPECT_EQ(found.prior_sd[j], numbers[j].prior_sd);
            // a share of what is believed of it; what is known for sure moves as well
            const double h = 2e-3 * std::max(0.05, numbers[j].prior_sd);
            const Eigen::VectorXd step = h * Eigen::VectorXd::Unit(start.size(), j);
            const Eigen::VectorXd difference =
                (seen(all, effect, start + step, forward) - seen(all, effect, start - step, forward)) / (2 * h);
            // equilibria to 1e-7 of the load over h, and h^2 / 6
            EXPECT_LE((found.columns.col(j) - difference).norm(), 1e-3 * difference.norm() + 1e-5)
                << effect->name() << " " << j;
        }
    }
    EXPECT_GE(tested, 4);
}

TEST_P(Screening, OfFibresTellsEveryDirectionFromFifteen) {
    const Problem all = problem(0.03);
    const ForwardSolution forward = solve_forward(*model_, all, bare_, 1);
    const auto effect = find_effect("anisotropy");
    const ScreenPlan plan = screen_plan(*effect, *model_, all, bare_, forward);
    EXPECT_EQ(plan.signatures.width, 15);
    const ScreenColumns found = plan.columns(sensitivities(*model_, all, bare_, forward, {plan.signatures}, 1).front());
    ASSERT_GT(found.alternatives(), 100);
    for (const Eigen::Index direction : {0, 17, 71, 149}) {
        // fibres along it, asked by themselves
        const Eigen::VectorXd start = plan.start(direction, Eigen::VectorXd::Ones(1));
        ASSERT_EQ(start[0], 1);
        ModelSetting with_fibres = bare_.setting();
        effect->enforce(start, with_fibres);
        const Signatures own{1, [&](int k, const Eigen::VectorXd& q) {
                                 const Action& action = forward.actions[k];
                                 return Signatures::InAction{.forces = model_->residual(q, with_fibres, action) -
                                                                       model_->residual(q, bare_.setting(), action),
                                                             .columns = {0}};
                             }};
        const Eigen::VectorXd column = sensitivities(*model_, all, bare_, forward, {own}, 1).front();
        // rounding, of products of 15 directions whose matrix has a condition number of some 1e2
        EXPECT_LT((found.columns.col(direction) - column).norm(), 1e-9 * column.norm()) << direction;
    }
}

TEST_P(Screening, OfFibresIsTheDerivativeByTheirModulus) {
    const Problem all = problem(0.03);
    const ForwardSolution forward = solve_forward(*model_, all, bare_, 1);
    const auto effect = find_effect("anisotropy");
    const ScreenPlan plan = screen_plan(*effect, *model_, all, bare_, forward);
    const ScreenColumns found = plan.columns(sensitivities(*model_, all, bare_, forward, {plan.signatures}, 1).front());
    Eigen::VectorXd ahead = plan.start(60, Eigen::VectorXd::Ones(1)), behind = ahead;
    constexpr double h = 2e-3;
    ahead[0] = h;
    behind[0] = -h;
    const Eigen::VectorXd difference =
        (seen(all, effect, ahead, forward) - seen(all, effect, behind, forward)) / (2 * h);
    EXPECT_GT(difference.norm(), 0.1);
    // equilibria to 1e-7 of the load over h, and h^2 / 6
    EXPECT_LT((found.columns.col(60) - difference).norm(), 1e-3 * difference.norm());
}

TEST_P(Screening, OfAnInclusionIsTheDerivativeByItsRatio) {
    const Problem all = problem(0.03);
    const ForwardSolution forward = solve_forward(*model_, all, bare_, 1);
    const auto effect = find_effect("inclusion");
    const ScreenPlan plan = screen_plan(*effect, *model_, all, bare_, forward);
    const ScreenColumns found = plan.columns(sensitivities(*model_, all, bare_, forward, {plan.signatures}, 1).front());
    ASSERT_GT(found.alternatives(), 5);
    int tested = 0;
    for (Eigen::Index place = 0; place < found.alternatives(); place += 7) {
        Eigen::VectorXd ahead = plan.start(place, Eigen::VectorXd::Ones(1)), behind = ahead;
        constexpr double h = 0.01;
        ahead[4] = h;
        behind[4] = -h;
        const Eigen::VectorXd difference =
            (seen(all, effect, ahead, forward) - seen(all, effect, behind, forward)) / (2 * h);
        if (difference.norm() < 1) continue;
        ++tested;
        // The ball's border cuts elements, which the screen takes as a whole.
        EXPECT_GT(found.columns.col(place).normalized().dot(difference.normalized()), 0.85) << place;
    }
    EXPECT_GT(tested, 0);
}

TEST_P(Screening, OfViscosityIsTheDerivativeByTheCreep) {
    const Problem all =
        make_problem(make_twin(*model_, body_.set(SmallBody::dwells(0.01, 3)), bare_, 0), 0.05).stage_by_stage();
    const ForwardSolution forward = solve_forward(*model_, all, bare_, 1);
    const auto effect = find_effect("viscosity");
    const ScreenPlan plan = screen_plan(*effect, *model_, all, bare_, forward);
    const ScreenColumns found = plan.columns(sensitivities(*model_, all, bare_, forward, {plan.signatures}, 1).front());
    EXPECT_TRUE(found.one_sided);
    for (const Eigen::Index tau : {0, 3, 7}) {
        Eigen::VectorXd ahead = plan.start(tau, Eigen::VectorXd::Ones(1)), behind = ahead;
        constexpr double h = 2e-3;
        ahead[0] = h;
        behind[0] = -h;
        const Eigen::VectorXd difference =
            (seen(all, effect, ahead, forward) - seen(all, effect, behind, forward)) / (2 * h);
        EXPECT_GT(difference.norm(), 1);
        EXPECT_LT((found.columns.col(tau) - difference).norm(), 1e-3 * difference.norm()) << tau;  // as above
    }
}

TEST_P(Screening, OfDamageIsTheDerivativeByItsShare) {
    // Links by the linear law take the material as it is at rest.
    if (GetParam().is_skeleton && GetParam().law == 0) return;
    const Problem all =
        make_problem(make_twin(*model_, body_.set(SmallBody::returns(0.1, 3)), bare_, 0), 0.05).stage_by_stage();
    const ForwardSolution forward = solve_forward(*model_, all, bare_, 1);
    const auto effect = find_effect("damage");
    const ScreenPlan plan = screen_plan(*effect, *model_, all, bare_, forward);
    const ScreenColumns found = plan.columns(sensitivities(*model_, all, bare_, forward, {plan.signatures}, 1).front());
    EXPECT_TRUE(found.one_sided);
    EXPECT_EQ(found.alternatives(), 6);
    const Eigen::VectorXd none = all.pick(forward.markers).cwiseQuotient(all.sigma);
    for (const Eigen::Index strain : {1, 3, 5}) {
        Eigen::VectorXd little = plan.start(strain, Eigen::VectorXd::Ones(1));
        constexpr double h = 2e-3;
        little[0] = h;
        const Eigen::VectorXd difference = (seen(all, effect, little, forward) - none) / h;
        EXPECT_GT(difference.norm(), 1);
        EXPECT_LT((found.columns.col(strain) - difference).norm(), 0.01 * difference.norm())
            << strain;  // its second order
    }
}

INSTANTIATE_TEST_SUITE_P(AllModels, Screening,
                         testing::Values(ScreenCase{"ReferenceLinear", false, 0}, ScreenCase{"ReferenceSvk", false, 1},
                                         ScreenCase{"ReferenceNeoHooke", false, 2},
                                         ScreenCase{"SkeletonLinear", true, 0},
                                         ScreenCase{"SkeletonLargeRotation", true, 1}),
                         [](const auto& about) { return about.param.name; });

}  // namespace
}  // namespace palpate::identify
