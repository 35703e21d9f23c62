#include "identify/effects/catalogue.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

#include "mesh/errors.h"
#include "small_body.h"

namespace palpate::identify {
namespace {

using testing::HasSubstr;

/// Names that users may rely on.
const std::set<std::string> promised{
    "gravity",  "stiffening", "anisotropy",        "inclusion", "volume",     "torsion",      "shear",      "contact",
    "pressure", "prestress",  "compliant-support", "viscosity", "plasticity", "misalignment", "force-gain", "outliers"};
const std::set<std::string> probe_kinds{"load", "orientation", "pressure", "dwell", "unload", "repeat", "fiducials"};

std::string message_of_find(const std::string& name) {
    try {
        find_effect(name);
    } catch (const InvalidInput& error) {
        return error.what();
    }
    return "nothing was thrown";
}

class EveryEffect : public testing::TestWithParam<std::shared_ptr<const Effect>> {
protected:
    const Effect& effect() const { return *GetParam(); }

    SmallBody body_;
    std::unique_ptr<ReferenceBody> model_ = body_.reference();
    Problem problem_ =
        make_problem(make_twin(*model_, body_.set(SmallBody::probes(0.01, 3)), bare_truth(*model_, 0), 0), 0.05);
};

TEST_P(EveryEffect, IsDescribedWithoutEmptyFields) {
    const EffectDescription& text = effect().description();
    for (const std::string& field : {text.name, text.meaning, text.reveals, text.separating_probe, text.next_probe}) {
        EXPECT_FALSE(field.empty());
    }
    EXPECT_FALSE(text.parameters.empty());
    for (const std::string& parameter : text.parameters) EXPECT_THAT(parameter, HasSubstr("["));  // its unit
    EXPECT_TRUE(promised.contains(text.name));
    EXPECT_TRUE(probe_kinds.contains(text.next_probe));
}

TEST_P(EveryEffect, IsConfusedWithOthersThatHaveNames) {
    EXPECT_FALSE(effect().description().confused_with.empty());
    for (const std::string& other : effect().description().confused_with) {
        EXPECT_TRUE(promised.contains(other)) << other;
        EXPECT_NE(other, effect().name());
    }
}

TEST_P(EveryEffect, IsFoundByItsName) { EXPECT_EQ(find_effect(effect().name())->name(), effect().name()); }

TEST_P(EveryEffect, IsOfTheBodyWhereModelsPlayIt) {
    EXPECT_EQ(effect().is_of_body(), skeleton::is_body_effect(effect().name()));
}

TEST_P(EveryEffect, HasNumbersWithNamesUnitsAndWidths) {
    std::set<std::string> names;
    for (const EffectNumber& number : effect().numbers(*model_, problem_)) {
        EXPECT_FALSE(number.name.empty());
        EXPECT_FALSE(number.unit.empty());
        EXPECT_GT(number.prior_sd, 0);
        EXPECT_TRUE(names.insert(number.name).second) << number.name;
    }
}

TEST_P(EveryEffect, WhatIsToldCanBeTakenBack) {
    const auto numbers = effect().numbers(*model_, problem_);
    Eigen::VectorXd values(std::ssize(numbers));
    for (Eigen::Index j = 0; j < values.size(); ++j) {
        values[j] = numbers[j].prior_mean + 0.1 * static_cast<double>(j + 1) * numbers[j].prior_sd;
    }
    const skeleton::Effect told = effect().told(numbers, values);
    EXPECT_EQ(told.name, effect().name());
    ASSERT_EQ(told.parameters.size(), numbers.size());
    for (std::size_t j = 0; j < numbers.size(); ++j) {
        EXPECT_EQ(told.parameters[j].name, numbers[j].name);
        EXPECT_EQ(told.parameters[j].unit, numbers[j].unit);
    }
    EXPECT_LT((effect().values(numbers, told) - values).norm(), 1e-13 * values.norm() + 1e-300);  // rounding
}

TEST_P(EveryEffect, WhatIsNotToldStartsAsAFitDoes) {
    const auto numbers = effect().numbers(*model_, problem_);
    const Eigen::VectorXd values = effect().values(numbers, {effect().name(), {}});
    ASSERT_EQ(values.size(), std::ssize(numbers));
    for (Eigen::Index j = 0; j < values.size(); ++j) EXPECT_EQ(values[j], numbers[j].start) << numbers[j].name;
}

TEST_P(EveryEffect, SpeaksASentence) {
    const auto numbers = effect().numbers(*model_, problem_);
    Eigen::VectorXd values = Eigen::VectorXd::Constant(std::ssize(numbers), 0.1);
    skeleton::Effect told = effect().told(numbers, values);
    if (effect().name() == "outliers")
        told.parameters = {{"share", 0.02, "1"}, {"readings", 3, "1"}, {"width", 8, "1"}};
    const std::string sentence = effect().sentence(told);
    EXPECT_TRUE(sentence.ends_with('.')) << sentence;
    EXPECT_THAT(sentence, testing::Not(HasSubstr("nan")));
}

TEST_P(EveryEffect, OfABodyIsWhatAModelFilePlays) {
    const auto numbers = effect().numbers(*model_, problem_);
    if (!effect().is_of_body() || numbers.empty()) return;
    Eigen::VectorXd values(std::ssize(numbers));
    for (Eigen::Index j = 0; j < values.size(); ++j) values[j] = numbers[j].prior_mean + 0.2;
    const auto own = effect().potential(values);
    const auto file = skeleton::make_potential(effect().told(numbers, values));
    ASSERT_TRUE(own);
    EXPECT_EQ(own->acts_on(), file->acts_on());
    const Vec3 X(1, 2, 3), x(1.5, 1.8, 3.3);
    EXPECT_LT((own->terms(X, x, false).gradient - file->terms(X, x, false).gradient).norm(),
              1e-12 * own->terms(X, x, false).gradient.norm());  // rounding
}

TEST_P(EveryEffect, OfTheMeasurementIsTakenOutOfASet) {
    // Readings with the fault in, corrected, are readings without it.
    if (effect().is_of_body()) return;
    const auto numbers = effect().numbers(*model_, problem_);
    if (numbers.empty()) return;
    Eigen::VectorXd values(std::ssize(numbers));
    for (Eigen::Index j = 0; j < values.size(); ++j) values[j] = 0.2 * static_cast<double>(j % 2 ? 1 : -1);
    const Explanation truth = bare_truth(*model_, 2), faulty = with(truth, GetParam(), values);
    const MeasurementSet set = effect().corrected(make_twin(*model_, body_.set(SmallBody::probes(0.01, 3)), faulty, 0),
                                                  effect().told(numbers, values));
    const Problem understood = make_problem(set, 0.05);
    const Eigen::VectorXd modelled = understood.pick(play(*model_, understood, truth, 1).markers);
    EXPECT_LT((understood.measured - modelled).cwiseAbs().maxCoeff(),
              1e-5);  // two equilibria, each to 1e-7 of its load
}

INSTANTIATE_TEST_SUITE_P(Catalogue, EveryEffect, testing::ValuesIn(catalogue()), [](const auto& about) {
    std::string name = about.param->name();
    std::erase(name, '-');
    return name;
});

/// Six probes, each with twice the load of the one before.
Problem doubling_loads() {
    Problem problem;
    for (int k = 0; k < 6; ++k) {
        problem.actions.push_back({.contacts = {{.force = Vec3(0, 0, -std::pow(2.0, k)), .radius = 1}}});
        problem.probe.push_back(k + 1);
    }
    return problem;
}

TEST(ForceGain, IsObjectedToWhereTheBodyStiffens) {
    // effective force F^0.8: gains that fall with the load in one line
    const Eigen::VectorXd falling = -0.2 * std::log(2.0) * Eigen::VectorXd::LinSpaced(6, 0, 5);
    EXPECT_THAT(find_effect("force-gain")->objection(doubling_loads(), falling, false), HasSubstr("stiffens"));
}

TEST(ForceGain, IsAClaimWhereGainsComeAndGo) {
    Eigen::VectorXd alternating(6);
    alternating << 0.2, -0.2, 0.2, -0.2, 0.2, -0.2;
    EXPECT_EQ(find_effect("force-gain")->objection(doubling_loads(), alternating, false), "");
    EXPECT_THAT(find_effect("force-gain")->objection(doubling_loads(), alternating, true), HasSubstr("noise already"));
}

TEST(Catalogue, NamesAreAllDifferent) {
    std::set<std::string> names;
    for (const auto& effect : catalogue()) EXPECT_TRUE(names.insert(effect->name()).second) << effect->name();
}

TEST(Catalogue, AWrongNameGetsASuggestion) {
    EXPECT_EQ(
        message_of_find("gravitiy").rfind("there is no effect 'gravitiy'; did you mean 'gravity'? Known are: ", 0), 0u);
    EXPECT_THAT(message_of_find("outlier"), HasSubstr("did you mean 'outliers'?"));
    for (const auto& effect : catalogue()) EXPECT_THAT(message_of_find("x"), HasSubstr(effect->name()));
}

}  // namespace
}  // namespace palpate::identify
