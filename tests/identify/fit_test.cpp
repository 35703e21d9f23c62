#include "identify/diagnose/fit.h"

#include <gtest/gtest.h>

#include <cmath>

#include "identify/effects/catalogue.h"
#include "small_body.h"

// What an explanation's numbers do to what is seen, against plays with other numbers.

namespace palpate::identify {
namespace {

struct Case {
    std::string effect;  // or "" for the stiffness alone
    bool is_skeleton;
    int law;
};

class Signature : public testing::TestWithParam<Case> {
protected:
    Signature() {
        body_.markers = SmallBody::with_pins();
        if (GetParam().is_skeleton) {
            model_ = body_.skeleton();
        } else {
            model_ = body_.reference();
        }
        truth_ = bare_truth(*model_, GetParam().law);
        // the readings matter to the size of an effect's numbers only
        problem_ = make_problem(make_twin(*model_, body_.set(SmallBody::probes(0.03, 4)), truth_, 0), 0.05);
        truth_.theta.array() += 0.1;
        if (GetParam().effect.empty()) return;
        const auto effect = find_effect(GetParam().effect);
        const auto numbers = effect->numbers(*model_, problem_);
        Eigen::VectorXd values(std::ssize(numbers));
        for (Eigen::Index j = 0; j < values.size(); ++j) {
            const EffectNumber& number = numbers[j];
            values[j] = number.prior_mean + 0.2 * number.prior_sd * (j % 2 ? 1 : -0.7);
        }
        truth_ = with(truth_, effect, values);
    }

    /// Coordinates in an explanation, over sigma (N). Neighbours start from its configurations.
    Eigen::VectorXd seen(const Explanation& explanation, const Played* near = nullptr) const {
        return problem_.pick(play(*model_, problem_, explanation, 1, near ? &near->q : nullptr).markers)
            .cwiseQuotient(problem_.sigma);
    }

    SmallBody body_;
    std::unique_ptr<BodyModel> model_;
    Problem problem_;
    Explanation truth_;
};

TEST_P(Signature, OfEveryNumberIsTheDerivativeOfWhatIsSeen) {
    const Played played = play(*model_, problem_, truth_, 1);
    const Eigen::MatrixXd columns =
        answers(*model_, problem_, truth_, played, {own_signatures(*model_, problem_, truth_)}, 1).front() +
        seen_directly(problem_, truth_, played);
    ASSERT_EQ(columns.cols(), truth_.numbers());
    for (Eigen::Index p = 0; p < columns.cols(); ++p) {
        // Equilibria are found to 1e-7 of the load, 2e-7 of the way that a marker moves: that over h, and h^2 / 6.
        constexpr double h = 2e-3;
        Explanation ahead = truth_, behind = truth_;
        ahead.set_all(truth_.all() + h * Eigen::VectorXd::Unit(columns.cols(), p));
        behind.set_all(truth_.all() - h * Eigen::VectorXd::Unit(columns.cols(), p));
        const Eigen::VectorXd difference = (seen(ahead, &played) - seen(behind, &played)) / (2 * h);
        EXPECT_LT((columns.col(p) - difference).norm(), 1e-3 * difference.norm()) << p;
        EXPECT_GT(difference.norm(), 0.1) << p;  // it shows
    }
}

TEST_P(Signature, StepsAreTheDerivativeOfTheConfiguration) {
    const Played played = play(*model_, problem_, truth_, 1);
    std::vector<Eigen::MatrixXd> steps;
    answers(*model_, problem_, truth_, played, {own_signatures(*model_, problem_, truth_)}, 1, &steps);
    constexpr double h = 1e-2;
    const Eigen::VectorXd way = Eigen::VectorXd::LinSpaced(truth_.numbers(), -1, 1);
    Explanation ahead = truth_;
    ahead.set_all(truth_.all() + h * way);
    const Played there = play(*model_, problem_, ahead, 1, &played.q);
    const Setting setting = truth_.setting();
    for (std::size_t k = 0; k < steps.size(); ++k) {
        // none where no number pulls at the body
        const Eigen::VectorXd step =
            steps[k].size() > 0 ? steps[k] * (h * way) : Eigen::VectorXd::Zero(model_->dofs()).eval();
        const Points guess = model_->observe(model_->advance(played.q[k], step, setting), setting);
        const double moved = (there.stand[k] - played.stand[k]).norm();
        EXPECT_LE((guess - there.stand[k]).norm(), 0.05 * moved + 1e-9) << k;  // the second order of a step of 1 %
    }
}

TEST_P(Signature, IsTheSameFromSeveralThreads) {
    const Played one = play(*model_, problem_, truth_, 1), two = play(*model_, problem_, truth_, 2);
    for (std::size_t k = 0; k < one.q.size(); ++k) EXPECT_EQ(one.q[k], two.q[k]);
    const Signatures own = own_signatures(*model_, problem_, truth_);
    EXPECT_EQ(answers(*model_, problem_, truth_, one, {own}, 1).front(),
              answers(*model_, problem_, truth_, one, {own}, 2).front());
}

std::vector<Case> all_cases() {
    std::vector<Case> cases;
    for (const char* effect : {"", "gravity", "compliant-support", "misalignment", "force-gain"}) {
        for (const int law : {0, 1, 2}) cases.push_back({effect, false, law});
        for (const int law : {0, 1}) cases.push_back({effect, true, law});
    }
    return cases;
}

std::string name_of(const testing::TestParamInfo<Case>& about) {
    std::string name = about.param.effect.empty() ? "stiffness" : about.param.effect;
    std::erase(name, '-');
    return (about.param.is_skeleton ? "skeleton_" : "reference_") + std::to_string(about.param.law) + "_" + name;
}

INSTANTIATE_TEST_SUITE_P(AllEffects, Signature, testing::ValuesIn(all_cases()), name_of);

class ScreenColumns : public testing::TestWithParam<Case> {
protected:
    ScreenColumns() {
        if (GetParam().is_skeleton) {
            model_ = body_.skeleton();
        } else {
            model_ = body_.reference();
        }
        bare_ = bare_truth(*model_, GetParam().law);
    }
    Problem problem(double force) const {
        return make_problem(make_twin(*model_, body_.set(SmallBody::probes(force, 4)), bare_, 0), 0.05);
    }

    /// What springs of stiffness k move, over sigma and their compliance, against the screen's column.
    struct Compared {
        Eigen::VectorXd column, moved;
    };
    Compared compliant_support(double force, double k) const {
        const Problem all = problem(force);
        const Played played = play(*model_, all, bare_, 1);
        const auto effect = find_effect("compliant-support");
        const Explanation soft = with(bare_, effect, Eigen::VectorXd::Constant(1, std::log(k)));
        const Eigen::VectorXd moved = all.pick(play(*model_, all, soft, 1, &played.q).markers) -
                                      all.pick(play(*model_, all, bare_, 1, &played.q).markers);
        return {effect->screen_columns(*model_, all, bare_, played, 1).columns.col(0),
                k * moved.cwiseQuotient(all.sigma)};
    }

    SmallBody body_;
    std::unique_ptr<BodyModel> model_;
    Explanation bare_;
};

TEST_P(ScreenColumns, OfACompliantSupportAreTheDerivativeByCompliance) {
    // The base moves as one where springs are soft against what they hold (E times 10 mm: 3 N/mm), and by little where
    // the load is a hair.
    const auto [column, moved] = compliant_support(1e-6, 0.03);
    EXPECT_LT((column - moved).norm(), 0.01 * moved.norm());  // their ratio, by a shape factor
}

TEST_P(ScreenColumns, OfACompliantSupportAreTheDerivativeAtNoneInLargeDeformation) {
    const auto [column, moved] = compliant_support(0.01, 1000);
    EXPECT_GT(moved.norm(), 1);
    if (GetParam().is_skeleton) {
        EXPECT_LT((column - moved).norm(), 0.01 * moved.norm());  // its base is one sphere: no approximation
    } else {
        // Next to springs as stiff as these the face deforms, which adds some 40 % of the same shape.
        EXPECT_GT(column.normalized().dot(moved.normalized()), 0.99);
        EXPECT_NEAR(column.norm() / moved.norm(), 1, 0.4);
    }
}

TEST_P(ScreenColumns, OfNeutralEffectsAreTheDerivativeAtNone) {
    const Problem all = problem(0.01);
    const Played played = play(*model_, all, bare_, 1);
    for (const auto& effect : catalogue()) {
        const auto numbers = effect->numbers(*model_, all);
        if (numbers.empty() || !effect->neutral_at_start()) continue;
        const Effect::ScreenColumns found = effect->screen_columns(*model_, all, bare_, played, 1);
        ASSERT_EQ(found.columns.cols(), std::ssize(numbers));
        for (Eigen::Index j = 0; j < found.columns.cols(); ++j) {
            EXPECT_EQ(found.prior_sd[j], numbers[j].prior_sd);
            constexpr double h = 2e-3;
            const auto seen = [&](double value) {
                const Explanation there = with(bare_, effect, value * Eigen::VectorXd::Unit(found.columns.cols(), j));
                return all.pick(play(*model_, all, there, 1, &played.q).markers);
            };
            const Eigen::VectorXd difference = (seen(h) - seen(-h)).cwiseQuotient(all.sigma) / (2 * h);
            EXPECT_LT((found.columns.col(j) - difference).norm(), 1e-3 * difference.norm())  // as above
                << effect->name() << " " << j;
        }
    }
}

INSTANTIATE_TEST_SUITE_P(AllModels, ScreenColumns,
                         testing::Values(Case{"", false, 0}, Case{"", false, 1}, Case{"", false, 2}, Case{"", true, 0},
                                         Case{"", true, 1}),
                         name_of);

}  // namespace
}  // namespace palpate::identify
