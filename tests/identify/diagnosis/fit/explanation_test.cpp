#include "identify/diagnosis/fit/explanation.h"

#include <gtest/gtest.h>

#include <cmath>

#include "identify/effects/catalogue.h"
#include "tests/identify/small_body.h"

// What an explanation's numbers do to what is seen, against plays with other numbers.

namespace palpate::identify {
namespace {

struct SignatureCase {
    std::string effect;  // or "" for the stiffness alone
    bool is_skeleton;
    int law;
};

class Signature : public testing::TestWithParam<SignatureCase> {
protected:
    Signature() {
        const bool has_memory = !GetParam().effect.empty() && find_effect(GetParam().effect)->has_memory();
        if (GetParam().effect == "pressure") body_ = SmallBody::hollow();
        body_.markers = SmallBody::with_pins();
        if (GetParam().is_skeleton) {
            model_ = body_.skeleton();
        } else {
            model_ = body_.reference();
        }
        truth_ = bare_truth(*model_, GetParam().law);
        // the readings matter to the size of an effect's numbers only
        const double force = GetParam().effect == "stiffening" ? 0.2 : 0.03;  // which strains the bar enough
        MeasurementSet set = body_.set(GetParam().effect == "plasticity" ? SmallBody::releases(0.1, 3)
                                       : GetParam().effect == "damage"   ? SmallBody::returns(0.1, 3)
                                       : has_memory                      ? SmallBody::dwells(force, 3)
                                                                         : SmallBody::probes(force, 4));
        set.material = MaterialGuess{.poisson = 0.45};
        problem_ = make_problem(make_twin(*model_, set, truth_, 0), 0.05);
        if (has_memory) problem_ = problem_.stage_by_stage();
        truth_.theta.array() += 0.1;
        if (GetParam().effect.empty()) return;
        const auto effect = find_effect(GetParam().effect);
        truth_ = with(truth_, effect, example(*effect, effect->numbers(*model_, problem_)));
    }

    /// Coordinates in an explanation, over sigma (N). Neighbours start from its configurations.
    Eigen::VectorXd seen(const Explanation& explanation, const ForwardSolution* near = nullptr) const {
        return problem_.pick(solve_forward(*model_, problem_, explanation, 1, near ? &near->q : nullptr).markers)
            .cwiseQuotient(problem_.sigma);
    }

    SmallBody body_;
    std::unique_ptr<BodyModel> model_;
    Problem problem_;
    Explanation truth_;
};

TEST_P(Signature, OfEveryNumberIsTheDerivativeOfWhatIsSeen) {
    const ForwardSolution forward = solve_forward(*model_, problem_, truth_, 1);
    const Eigen::MatrixXd columns =
        sensitivities(*model_, problem_, truth_, forward, {own_signatures(*model_, problem_, truth_, forward)}, 1)
            .front() +
        seen_directly(*model_, problem_, truth_, forward);
    ASSERT_EQ(columns.cols(), truth_.numbers());
    ASSERT_TRUE(truth_.effects.empty() || truth_.values.front().size() > 0);
    for (Eigen::Index p = 0; p < columns.cols(); ++p) {
        // Equilibria are found to 1e-7 of the load, 2e-7 of the way that a marker moves: that over h, and h^2 / 6.
        constexpr double h = 2e-3;
        Explanation ahead = truth_, behind = truth_;
        ahead.set_all(truth_.all() + h * Eigen::VectorXd::Unit(columns.cols(), p));
        behind.set_all(truth_.all() - h * Eigen::VectorXd::Unit(columns.cols(), p));
        const Eigen::VectorXd difference = (seen(ahead, &forward) - seen(behind, &forward)) / (2 * h);
        // The border of an inclusion has kinks, and so has yielding, which some of the few points of the mesh cross on
        // that way.
        const double within = GetParam().effect == "inclusion" ? 0.05 : GetParam().effect == "plasticity" ? 5e-3 : 1e-3;
        EXPECT_LT((columns.col(p) - difference).norm(), within * difference.norm()) << p;
        EXPECT_GT(difference.norm(), 0.1) << p;  // it shows
    }
}

TEST_P(Signature, OfTheLastEffectIsItsOwnPartOfAll) {
    // of a body that remembers it is without what it was through
    if (truth_.effects.empty() || truth_.setting().effects.remember()) return;
    const ForwardSolution forward = solve_forward(*model_, problem_, truth_, 1);
    const Eigen::Index own = truth_.values.front().size();
    const Signatures all = own_signatures(*model_, problem_, truth_, forward);
    const Signatures last{own, [&](int k, const Eigen::VectorXd& q) {
                              return signatures_of_last_effect(*model_, problem_, truth_, forward, k, q);
                          }};
    const auto answered = sensitivities(*model_, problem_, truth_, forward, {all, last}, 1);
    // the same numbers, but for the order of summation in the solve
    EXPECT_LE((answered[0].rightCols(own) - answered[1]).norm(), 1e-12 * answered[0].norm());
}

TEST_P(Signature, StepsAreTheDerivativeOfTheConfiguration) {
    const ForwardSolution forward = solve_forward(*model_, problem_, truth_, 1);
    std::vector<Eigen::MatrixXd> steps;
    sensitivities(*model_, problem_, truth_, forward, {own_signatures(*model_, problem_, truth_, forward)}, 1, &steps);
    constexpr double h = 1e-3;
    const Eigen::VectorXd direction = Eigen::VectorXd::LinSpaced(truth_.numbers(), -1, 1);
    Explanation ahead = truth_;
    ahead.set_all(truth_.all() + h * direction);
    const ForwardSolution there = solve_forward(*model_, problem_, ahead, 1, &forward.q);
    const ModelSetting setting = truth_.setting();
    for (std::size_t k = 0; k < steps.size(); ++k) {
        // none where no number pulls at the body
        const Eigen::VectorXd step =
            steps[k].size() > 0 ? steps[k] * (h * direction) : Eigen::VectorXd::Zero(model_->dofs()).eval();
        const Points guess = model_->observe(model_->advance(forward.q[k], step, setting), setting);
        const double moved = (there.channels[k] - forward.channels[k]).norm();
        EXPECT_LE((guess - there.channels[k]).norm(), 0.05 * moved + 1e-9) << k;  // the second order of a small step
    }
}

TEST_P(Signature, IsTheSameFromSeveralThreads) {
    const ForwardSolution one = solve_forward(*model_, problem_, truth_, 1),
                          two = solve_forward(*model_, problem_, truth_, 2);
    for (std::size_t k = 0; k < one.q.size(); ++k) EXPECT_EQ(one.q[k], two.q[k]);
    const Signatures own = own_signatures(*model_, problem_, truth_, one);
    EXPECT_EQ(sensitivities(*model_, problem_, truth_, one, {own}, 1).front(),
              sensitivities(*model_, problem_, truth_, one, {own}, 2).front());
}

std::vector<SignatureCase> signature_cases() {
    std::vector<SignatureCase> cases;
    const auto add = [&](const char* effect, bool is_skeleton) {
        for (int law = 0; law < (is_skeleton ? 2 : 3); ++law) cases.push_back({effect, is_skeleton, law});
    };
    for (const char* effect :
         {"", "gravity", "anisotropy", "inclusion", "compliant-support", "viscosity", "misalignment", "force-gain"}) {
        add(effect, false);
        add(effect, true);
    }
    // Few of a skeleton's vertices meet a plane: it has kinks. A chain does not know a stress across it.
    for (const char* effect : {"volume", "pressure", "contact"}) add(effect, false);
    // In small strain this bar buckles under its stress.
    for (const int law : {1, 2}) cases.push_back({"prestress", false, law});
    cases.push_back({"plasticity", false, 2});
    for (const int law : {0, 1, 2}) cases.push_back({"damage", false, law});
    cases.push_back({"damage", true, 1});
    for (const char* effect : {"torsion", "shear"}) add(effect, true);
    // small strain knows no stiffening
    for (const int law : {1, 2}) cases.push_back({"stiffening", false, law});
    cases.push_back({"stiffening", true, 1});
    return cases;
}

std::string name_of(const testing::TestParamInfo<SignatureCase>& about) {
    std::string name = about.param.effect.empty() ? "stiffness" : about.param.effect;
    std::erase(name, '-');
    return (about.param.is_skeleton ? "skeleton_" : "reference_") + std::to_string(about.param.law) + "_" + name;
}

INSTANTIATE_TEST_SUITE_P(AllEffects, Signature, testing::ValuesIn(signature_cases()), name_of);

}  // namespace
}  // namespace palpate::identify
