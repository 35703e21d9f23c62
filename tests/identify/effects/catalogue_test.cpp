#include "identify/effects/catalogue.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>

#include "fem/effects/registry.h"
#include "mesh/errors.h"
#include "tests/identify/lattice.h"
#include "tests/identify/small_body.h"
#include "tests/messages.h"

namespace palpate::identify {
namespace {

using testing::HasSubstr;

/// Names that users may rely on.
const std::set<std::string> promised{"gravity",        "stiffening", "anisotropy",  "inclusion",
                                     "volume",         "torsion",    "shear",       "contact",
                                     "pressure",       "prestress",  "swelling",    "compliant-support",
                                     "viscosity",      "plasticity", "damage",      "friction",
                                     "misalignment",   "force-gain", "slip",        "actuation-gain",
                                     "clock",          "outliers",   "local-force", "local-springs",
                                     "local-swelling", "map"};
const std::set<std::string> probe_kinds{"load", "orientation", "pressure", "dwell", "unload", "repeat", "fiducials"};

class EveryEffect : public testing::TestWithParam<std::shared_ptr<const EffectHypothesis>> {
protected:
    const EffectHypothesis& effect() const { return *GetParam(); }

    /// A body and a set in which all effects of bodies and rigs can show.
    EveryEffect() {
        if (effect().name() == "pressure") body_ = SmallBody::hollow();
        set_ = body_.set(SmallBody::dwells(0.01, 3));
        if (effect().name() == "clock") set_ = body_.set(SmallBody::steps());
        if (effect().name() == "damage") set_ = body_.set(SmallBody::returns());
        if (effect().is_of_links()) {
            model_ = body_.skeleton();
        } else if (std::set<std::string>{"slip", "actuation-gain", "friction"}.contains(effect().name())) {
            put_in_a_rig();
        } else {
            model_ = body_.reference();
        }
        set_.material = MaterialGuess{.poisson = 0.45};
        problem_ = make_problem(make_twin(*model_, set_, bare_truth(*model_, 0), 0), 0.05);
    }

    /// A grip at the free end, and a tendon along the bar.
    void put_in_a_rig() {
        const mesh::GripShape end{{mesh::BoxRegion{Vec3(35, -1, -1), Vec3(41, 11, 11)}}};
        Points path(3, 3);
        path << 0, 5, 8, 18, 5, 8, 30, 5, 8;
        set_.states.resize(3);
        set_.states[1].motions = {{.tool = 0, .translation = Vec3(0, 2, 1)}};
        set_.states[2].actuations = {{.actuator = 0, .value = 0.05}};
        set_.tools = {{.name = "grip", .shape = end, .bonded = true, .origin = Vec3(37.5, 5, 5)}};
        set_.actuators = {{.name = "cable", .kind = mesh::TendonActuator{path, false}}};
        for (LoadState& state : set_.states) state.contacts.clear();
        const Rig rig{set_.tools, set_.actuators};
        model_ =
            std::make_unique<ReferenceBody>(body_.mesh, body_.supports, body_.markers,
                                            ReferenceBodyOptions{.young = 0.1, .measured_on_mesh = true, .rig = rig});
    }

    SmallBody body_;
    MeasurementSet set_;
    std::unique_ptr<BodyModel> model_;
    Problem problem_;
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

TEST_P(EveryEffect, HasARowOfPhysicsOfItsKind) {
    const skeleton::KnownEffect* row = skeleton::find_known_effect(effect().name());
    ASSERT_NE(row, nullptr);
    EXPECT_EQ(row->kind, effect().description().kind);
    EXPECT_EQ(static_cast<bool>(row->make), effect().is_of_body());
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
    const Eigen::VectorXd values = example(effect(), numbers);
    const skeleton::EffectRecord estimate = effect().record(numbers, values);
    EXPECT_EQ(estimate.name, effect().name());
    for (const skeleton::EffectParameter& parameter : estimate.parameters) {
        const auto number = std::ranges::find(numbers, parameter.name, &EffectNumber::name);
        ASSERT_NE(number, numbers.end()) << parameter.name;
        EXPECT_EQ(parameter.unit, number->unit);
    }
    EXPECT_LT((effect().values(numbers, estimate) - values).norm(), 1e-13 * values.norm() + 1e-300);  // rounding
}

TEST_P(EveryEffect, HasNumbersWhereItCanShow) {
    EXPECT_EQ(effect().numbers(*model_, problem_).empty(), effect().sets_readings_aside());
}

TEST_P(EveryEffect, WhatIsNotToldStartsAsAFitDoes) {
    const auto numbers = effect().numbers(*model_, problem_);
    const Eigen::VectorXd values = effect().values(numbers, {effect().name(), {}});
    ASSERT_EQ(values.size(), std::ssize(numbers));
    for (Eigen::Index j = 0; j < values.size(); ++j) EXPECT_EQ(values[j], numbers[j].start) << numbers[j].name;
}

TEST_P(EveryEffect, SpeaksASentence) {
    const auto numbers = effect().numbers(*model_, problem_);
    skeleton::EffectRecord estimate = effect().record(numbers, example(effect(), numbers));
    if (effect().name() == "outliers")
        estimate.parameters = {{"share", 0.02, "1"}, {"readings", 3, "1"}, {"width", 8, "1"}};
    const std::string sentence = effect().sentence(estimate);
    EXPECT_TRUE(sentence.ends_with('.')) << sentence;
    EXPECT_THAT(sentence, testing::Not(HasSubstr("nan")));
}

TEST_P(EveryEffect, SaysHowWellItsNumbersAreKnown) {
    const auto numbers = effect().numbers(*model_, problem_);
    if (numbers.empty()) return;
    const skeleton::EffectRecord estimate = effect().record(numbers, example(effect(), numbers));
    Eigen::VectorXd sd(std::ssize(estimate.parameters));
    for (Eigen::Index j = 0; j < sd.size(); ++j)
        sd[j] = 0.1 * std::abs(estimate.parameters[static_cast<std::size_t>(j)].value) + 1e-3;
    const Eigen::MatrixXd covariance = sd.cwiseAbs2().asDiagonal();
    EXPECT_THAT(effect().sentence_with(estimate, covariance), HasSubstr("±"));
}

TEST_P(EveryEffect, OfABodyIsWhatAModelFilePlays) {
    // In force by the fit's numbers and by what a model file says, the body feels the same.
    const auto numbers = effect().numbers(*model_, problem_);
    if (!effect().is_of_body()) return;
    const Eigen::VectorXd values = example(effect(), numbers);
    const ModelSetting bare = bare_truth(*model_, 1).setting();
    ModelSetting own = bare, file = bare;
    effect().enforce(values, own);
    own.theta = bare.theta;  // a Poisson's ratio is in no file
    file.effects = skeleton::make_physics(effect().record(numbers, values));
    EXPECT_EQ(own.effects.points.size(), file.effects.points.size());
    EXPECT_EQ(own.effects.material.size(), file.effects.material.size());
    ASSERT_EQ(own.effects.creep.has_value(), file.effects.creep.has_value());
    if (own.effects.creep) {
        EXPECT_DOUBLE_EQ(own.effects.creep->creep, file.effects.creep->creep);
        EXPECT_DOUBLE_EQ(own.effects.creep->tau, file.effects.creep->tau);
    }
    const Action push{.contacts = SmallBody::probes(0.01)[1].contacts};
    const Eigen::VectorXd bent = model_->equilibrium(bare, push);
    const Eigen::VectorXd force = model_->residual(bent, own, push);
    const double without = model_->residual(bent, bare, push).norm();
    EXPECT_LT((force - model_->residual(bent, file, push)).norm(), 1e-12 * (force.norm() + without));  // rounding
}

TEST_P(EveryEffect, OfABodyComesToNumbersThatAModelFileTakes) {
    // A fit leads numbers anywhere down to their least, and far from where their priors have them; with a ratio of
    // Poisson's below -0.9 no body plays.
    const auto numbers = effect().numbers(*model_, problem_);
    if (!effect().is_of_body()) return;
    for (const double far : {-1.5, -0.5, 0.5, 1.5}) {
        Eigen::VectorXd values = example(effect(), numbers);
        for (Eigen::Index j = 0; j < values.size(); ++j) {
            values[j] = std::max(values[j] + far * numbers[j].prior_sd, numbers[j].least);
        }
        EXPECT_NO_THROW(skeleton::make_physics(effect().record(numbers, values))) << far;
    }
}

TEST_P(EveryEffect, OfTheMeasurementIsTakenOutOfASet) {
    // Readings with the fault in, corrected, are readings without it.
    if (effect().is_of_body()) return;
    const auto numbers = effect().numbers(*model_, problem_);
    if (numbers.empty()) return;
    Eigen::VectorXd values(std::ssize(numbers));
    for (Eigen::Index j = 0; j < values.size(); ++j) values[j] = 0.2 * static_cast<double>(j % 2 ? 1 : -1);
    const Explanation truth = bare_truth(*model_, 2), faulty = with(truth, GetParam(), values);
    const MeasurementSet set =
        effect().corrected(make_twin(*model_, set_, faulty, 0), effect().record(numbers, values));
    const Problem understood = make_problem(set, 0.05);
    const Eigen::VectorXd modelled = understood.pick(solve_forward(*model_, understood, truth, 1).markers);
    EXPECT_LT((understood.measured - modelled).cwiseAbs().maxCoeff(),
              1e-5);  // two equilibria, each to 1e-7 of its load
}

TEST(UnnamedSources, AreNotSearchedByADiagnosis) {
    for (const auto& source : unnamed_sources()) {
        EXPECT_EQ(std::ranges::find(catalogue(), source), catalogue().end()) << source->name();
        EXPECT_EQ(find_effect(source->name()), source);
    }
}

INSTANTIATE_TEST_SUITE_P(Catalogue, EveryEffect, testing::ValuesIn(all_effects()), [](const auto& about) {
    std::string name = about.param->name();
    std::erase(name, '-');
    return name;
});

TEST(Catalogue, RefusesASecondEffectOfAName) {
    const std::size_t before = catalogue().size();
    try {
        register_effect(*skeleton::find_known_effect("gravity"), find_effect("gravity"));
        FAIL() << "nothing was thrown";
    } catch (const InvalidInput& error) {
        EXPECT_STREQ(error.what(), "there is an effect 'gravity' already; give yours another name");
    }
    EXPECT_EQ(catalogue().size(), before);
}

/// An effect that the catalogue does not have.
class Wind : public EffectHypothesis {
public:
    const EffectDescription& description() const override {
        static const EffectDescription text{"wind", EffectKind::body, {}, {}, {}, {}, {}, {}};
        return text;
    }
    std::vector<EffectNumber> numbers(const BodyModel&, const Problem&) const override { return {}; }
    std::string sentence(const skeleton::EffectRecord&) const override { return "Wind."; }
};

TEST(Catalogue, RefusesARowWhoseHalvesDiffer) {
    const auto wind = std::make_shared<Wind>();
    EXPECT_EQ(message_of([&] {
                  register_effect({"storm", {}, {}}, wind);
              }),
              "effect 'wind' of the body is given the physics of 'storm' of the body; name and kind must agree");
    EXPECT_EQ(message_of([&] {
                  register_effect({"wind", {}, {}, EffectKind::measurement}, wind);
              }),
              "effect 'wind' of the body is given the physics of 'wind' of the measurement; name and kind must agree");
    EXPECT_EQ(effect_named("wind"), nullptr);
    EXPECT_EQ(skeleton::find_known_effect("storm"), nullptr);
}

TEST(Catalogue, KnowsAllWhosePhysicsIsKnown) {
    for (const std::string& name : fem::EffectRegistry::instance().names())
        EXPECT_NE(effect_named(name), nullptr) << name;
}

TEST(Catalogue, NamesAreAllDifferent) {
    std::set<std::string> names;
    for (const auto& effect : catalogue()) EXPECT_TRUE(names.insert(effect->name()).second) << effect->name();
}

TEST(Catalogue, EachEffectDrawsFromTheStreamThatItAlwaysDid) {  // digits of a seed hang on them
    const std::map<std::string, std::uint64_t> streams{
        {"gravity", 0},    {"compliant-support", 1}, {"pressure", 2},    {"prestress", 3},
        {"volume", 4},     {"torsion", 5},           {"shear", 6},       {"stiffening", 7},
        {"anisotropy", 8}, {"viscosity", 9},         {"plasticity", 10}, {"inclusion", 11},
        {"contact", 12},   {"misalignment", 13},     {"force-gain", 14}, {"outliers", 15},
        {"clock", 16},     {"swelling", 17},         {"damage", 18},     {"friction", 19},
        {"slip", 20},      {"actuation-gain", 21},   {"map", 22}};
    for (const auto& [name, stream] : streams) EXPECT_EQ(find_effect(name)->stream(), stream) << name;
}

TEST(Catalogue, OneEffectStandsForSingleReadings) {
    EXPECT_EQ(std::ranges::count_if(catalogue(), &EffectHypothesis::sets_readings_aside), 1);
    EXPECT_EQ(effect_of_single_readings()->name(), "outliers");
}

TEST(Catalogue, AWrongNameGetsASuggestion) {
    EXPECT_EQ(message_of([] {
                  find_effect("gravitiy");
              }).rfind("effect 'gravitiy' is not known (did you mean 'gravity'?); known are 'gravity', ", 0),
              0u);
    EXPECT_THAT(message_of([] { find_effect("outlier"); }), HasSubstr("did you mean 'outliers'?"));
    for (const auto& effect : catalogue()) EXPECT_THAT(message_of([] { find_effect("x"); }), HasSubstr(effect->name()));
}

}  // namespace
}  // namespace palpate::identify
