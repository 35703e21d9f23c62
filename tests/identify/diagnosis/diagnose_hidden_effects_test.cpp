#include <cmath>

#include "tests/identify/diagnosed.h"

// Each effect of a body hidden in readings of that very body: it is named, with its numbers; taken out of the catalogue
// it is missed. Those that need no more than plain probes are in diagnose_test.cpp.

namespace palpate::identify {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::IsEmpty;
using testing::UnorderedElementsAre;

struct HiddenCase {
    std::string effect;
    Eigen::VectorXd values;  // the fit's numbers
    double force;            // of the probes, as a multiple of their own [N]
    int probes = 8;
};

/// Effects large enough for the bar to show them: its fibres and its stiffening matter to strains of some 10 %.
std::vector<HiddenCase> hidden_cases() {
    return {{"stiffening", numbers({1, 0}), 0.2},
            {"anisotropy", numbers({1.5, 0.48, 0.6, 0.64}), 0.2},
            {"inclusion", numbers({27, 5, 5, std::log(6.7), std::log(4)}), 0.1},
            // So near that several places touch it: of a plane that the tip alone meets nothing tells the tilt.
            {"contact", numbers({0, 0, 1, -0.2, std::log(0.5)}), 0.03},
            {"pressure", numbers({0.03}), 0.03, 4},
            {"prestress", numbers({0.05, -0.03, 0.02, 0.03, -0.02, 0.01}), 0.03},
            {"swelling", numbers({0.02}), 0.03},
            {"viscosity", numbers({0.5, std::log(3)}), 0.03, 4},
            {"plasticity", numbers({std::log(0.03), std::log(0.3)}), 0.1, 4},
            {"damage", numbers({1, std::log(0.05)}), 0.1, 4},
            {"clock", numbers({0.2}), 0.05, 4}};
}

class HiddenEffect : public testing::TestWithParam<HiddenCase> {
protected:
    HiddenEffect() {
        if (GetParam().effect == "pressure") body_ = SmallBody::hollow();
        model_ = body_.reference();
        effect_ = find_effect(GetParam().effect);
        const bool yields = GetParam().effect == "plasticity", creeps = GetParam().effect == "viscosity";
        const bool lags = GetParam().effect == "clock", softens = GetParam().effect == "damage";
        const auto states = lags      ? SmallBody::steps
                            : softens ? SmallBody::returns
                            : yields  ? SmallBody::releases
                            : creeps  ? SmallBody::dwells
                                      : SmallBody::probes;
        set_ = make_twin(*model_, body_.set(states(GetParam().force, GetParam().probes)),
                         with(bare_truth(*model_, neo_hookean), effect_, GetParam().values), sigma);
        // St. Venant and Kirchhoff's law would bear some of it, and where the bar is bent far it has no equilibria.
        options_.law = neo_hookean;
        // The readings come from this very mesh: it ends the support where they do.
        options_.refit.nuisances.ragged = 0;
    }

    SmallBody body_;
    std::unique_ptr<ReferenceBody> model_;
    std::shared_ptr<const EffectHypothesis> effect_;
    MeasurementSet set_;
    DiagnoseOptions options_;
};

TEST_P(HiddenEffect, IsNamedWithItsNumbers) {
    const Diagnosis found = diagnose(*model_, set_, options_);
    EXPECT_EQ(found.verdict, Verdict::missing_effect);
    ASSERT_THAT(found.explanation, ElementsAre(GetParam().effect));
    const Candidate& first = found.ranking.front();
    EXPECT_EQ(first.effect->name(), GetParam().effect);
    const skeleton::EffectRecord truth = effect_->record(effect_->numbers(*model_, found.problem), GetParam().values);
    ASSERT_EQ(first.estimate.effect.parameters.size(), truth.parameters.size());
    for (std::size_t p = 0; p < truth.parameters.size(); ++p) {
        EXPECT_NEAR(first.estimate.effect.parameters[p].value, truth.parameters[p].value, 3 * first.estimate.sd[p])
            << truth.parameters[p].name;
    }
    EXPECT_NEAR(found.best().explanation.theta[0], std::log(SmallBody::young),
                3 * std::sqrt(found.best().covariance(0, 0)));
    // at most 4 sigma of chi^2 of some 600 rows
    EXPECT_LT(found.best().whitened_rms, 1 + 4 / std::sqrt(2.0 * static_cast<double>(found.problem.rows())));
    EXPECT_GT(found.baseline.whitened_rms, 1.1);
}

TEST_P(HiddenEffect, LeadsTheRanking) {
    const Diagnosis found = diagnose(*model_, set_, options_);
    const Candidate& first = found.ranking.front();
    EXPECT_EQ(first.effect->name(), GetParam().effect);
    EXPECT_TRUE(first.refit);
    EXPECT_GT(first.log_bayes_factor, 10);
    EXPECT_GT(first.probability, 0.99);
    EXPECT_GT(first.screened, options_.least_screen);
}

TEST_P(HiddenEffect, LeftOutOfTheCatalogueIsNotExplained) {
    options_.without = {GetParam().effect};
    const Diagnosis found = diagnose(*model_, set_, options_);
    // A body that comes late and readings that are stamped late are alike, and what swells is under the stress that
    // would hold it back; each says so of the other.
    if (GetParam().effect == "viscosity" || GetParam().effect == "clock" || GetParam().effect == "swelling") {
        for (const std::string& alias : found.explanation)
            EXPECT_THAT(effect_->description().confused_with, Contains(alias));
        return;
    }
    if (GetParam().effect == "inclusion") {  // a field of stiffness has a ball in it, if need be
        EXPECT_THAT(found.explanation, ElementsAre("map"));
        return;
    }
    EXPECT_EQ(found.verdict, Verdict::unexplained);
    EXPECT_THAT(found.explanation, IsEmpty());
    EXPECT_FALSE(found.explained);
}

INSTANTIATE_TEST_SUITE_P(OfABody, HiddenEffect, testing::ValuesIn(hidden_cases()),
                         [](const auto& about) { return about.param.effect; });

// --- A Poisson's ratio that the set declares ----------------------------------------------------------------------

class DeclaredRatio : public Diagnosed {
protected:
    /// Readings of a body of nu = 0.45, in a set that declares another.
    Diagnosis diagnosed(double declared) const {
        MeasurementSet set = make_twin(*model_, body_.set(SmallBody::probes()), truth(), sigma);
        set.material = MaterialGuess{.poisson = declared};
        DiagnoseOptions options;
        options.law = neo_hookean;
        ReferenceBodyOptions estimate{.young = 0.1};
        if (!std::isnan(declared)) estimate.poisson = declared;
        const ReferenceBody body(body_.mesh, body_.supports, body_.markers, estimate);
        return identify::diagnose(body, set, options);
    }
};

TEST_F(DeclaredRatio, ThatIsRightOrMissingLacksNothing) {
    for (const double declared : {missing, 0.45}) {
        const Diagnosis found = diagnosed(declared);
        EXPECT_EQ(found.verdict, Verdict::adequate) << declared;
        EXPECT_THAT(found.explanation, IsEmpty());
    }
}

TEST_F(DeclaredRatio, ThatTheReadingsContradictIsNamed) {
    const Diagnosis found = diagnosed(0.2);
    EXPECT_EQ(found.verdict, Verdict::missing_effect);
    ASSERT_THAT(found.explanation, ElementsAre("volume"));
    EXPECT_NEAR(estimate(found.ranking.front(), "poisson"), 0.45, 3 * found.ranking.front().estimate.sd[0]);
}

TEST_F(DeclaredRatio, IsNoCandidateWhereNoneIsDeclared) {
    const Diagnosis found = diagnosed(missing);
    for (const Candidate& c : found.ranking) EXPECT_NE(c.effect->name(), "volume");
}

// --- Several at once ----------------------------------------------------------------------------------------------

class HiddenTogether : public Diagnosed {
protected:
    Diagnosis diagnosed(const Explanation& hidden, double force) const {
        DiagnoseOptions options;
        options.law = neo_hookean;
        return diagnose(make_twin(*model_, body_.set(SmallBody::probes(force)), hidden, sigma), options);
    }
    void expect_near(const Diagnosis& found, const std::string& effect, const Eigen::VectorXd& values) const {
        const Candidate& c = candidate(found, effect);
        const auto known = find_effect(effect);
        const skeleton::EffectRecord truth = known->record(known->numbers(*model_, found.problem), values);
        ASSERT_EQ(c.estimate.sd.size(), truth.parameters.size());
        for (std::size_t p = 0; p < truth.parameters.size(); ++p) {
            EXPECT_NEAR(c.estimate.effect.parameters[p].value, truth.parameters[p].value, 4 * c.estimate.sd[p])
                << truth.parameters[p].name;
        }
    }
};

TEST_F(HiddenTogether, GravityAndMisalignmentAreBothNamed) {
    const Eigen::VectorXd moved = numbers({0.3, -0.2, 0.1, 0.01, -0.015, 0.02});
    const Diagnosis found = diagnosed(with(truth("gravity", half_g), find_effect("misalignment"), moved), 0.03);
    EXPECT_EQ(found.verdict, Verdict::missing_effect);
    EXPECT_THAT(found.explanation, UnorderedElementsAre("gravity", "misalignment"));
    expect_near(found, "gravity", half_g);
    expect_near(found, "misalignment", moved);
    EXPECT_LT(found.best().whitened_rms, 1.1);
}

TEST_F(HiddenTogether, AnInclusionUnderGravityAreBothNamed) {
    const Eigen::VectorXd ball = numbers({27, 5, 5, std::log(6.7), std::log(4)});
    const Diagnosis found = diagnosed(with(truth("gravity", half_g), find_effect("inclusion"), ball), 0.1);
    EXPECT_EQ(found.verdict, Verdict::missing_effect);
    EXPECT_THAT(found.explanation, UnorderedElementsAre("gravity", "inclusion"));
    expect_near(found, "gravity", half_g);
    expect_near(found, "inclusion", ball);
}

TEST_F(HiddenTogether, AreNotSoughtWhereOneIsAsked) {
    const Eigen::VectorXd moved = numbers({0.3, -0.2, 0.1, 0.01, -0.015, 0.02});
    DiagnoseOptions options;
    options.law = neo_hookean;
    options.together = 1;
    const Diagnosis found = diagnose(twin(with(truth("gravity", half_g), find_effect("misalignment"), moved)), options);
    EXPECT_EQ(found.verdict, Verdict::unexplained);
    for (const FittedExplanation& one : found.tried) EXPECT_EQ(one.effects.size(), 1u);
}

TEST_F(HiddenTogether, ASecondEffectHasToBeWorthIt) {
    // One alone explains all: whatever was tried beside it is no part of the explanation.
    const Diagnosis found = diagnosed(truth("gravity", half_g), 0.03);
    EXPECT_THAT(found.explanation, ElementsAre("gravity"));
    ASSERT_TRUE(found.explained);
    EXPECT_EQ(found.explained->effects.size(), 1u);
    EXPECT_THAT(found.explained->estimate("gravity").effect.parameters, testing::SizeIs(3));
    EXPECT_FALSE(found.explained->has("misalignment"));
}

// --- Effects that a model knows or does not -----------------------------------------------------------------------

TEST(Candidates, ArePressuresOnlyOfBodiesWithCavities) {
    const SmallBody solid, hollow = SmallBody::hollow();
    const auto names = [](const BodyModel& model, const SmallBody& body) {
        const Problem problem =
            make_problem(make_twin(model, body.set(SmallBody::probes(0.01, 2)), bare_truth(model, 0), 0), sigma);
        std::vector<std::string> result;
        for (const auto& effect : catalogue()) {
            if (!effect->numbers(model, problem).empty()) result.push_back(effect->name());
        }
        return result;
    };
    EXPECT_FALSE(solid.reference()->has_cavities());
    EXPECT_TRUE(hollow.reference()->has_cavities());
    EXPECT_THAT(names(*solid.reference(), solid), testing::Not(Contains("pressure")));
    EXPECT_THAT(names(*hollow.reference(), hollow), Contains("pressure"));
    // and links twist and shear in skeletons alone
    EXPECT_THAT(names(*solid.skeleton(), solid), testing::IsSupersetOf({"torsion", "shear"}));
    EXPECT_THAT(names(*solid.reference(), solid), testing::Not(Contains("torsion")));
    EXPECT_THAT(names(*solid.reference(), solid), testing::Not(Contains("shear")));
    // nothing creeps, yields or has softened in one reading of each load
    for (const char* history : {"viscosity", "plasticity", "damage"}) {
        EXPECT_THAT(names(*solid.reference(), solid), testing::Not(Contains(history)));
    }
}

// More torsion than links have anyway is another stiffness of theirs, which every explanation fits.
class HiddenInLinks : public testing::TestWithParam<std::string> {};

TEST_P(HiddenInLinks, IsNamedByTheSkeletonItself) {
    const SmallBody body;
    const auto skeleton = body.skeleton();
    const auto effect = find_effect(GetParam());
    const MeasurementSet set = make_twin(*skeleton, body.set(SmallBody::probes(0.05)),
                                         with(bare_truth(*skeleton, 1), effect, numbers({0.5})), sigma);
    DiagnoseOptions options;
    options.law = 1;
    const Diagnosis found = diagnose(*skeleton, set, options);
    EXPECT_EQ(found.verdict, Verdict::missing_effect);
    ASSERT_THAT(found.explanation, ElementsAre(GetParam()));
    const EffectEstimate& estimate = found.ranking.front().estimate;
    EXPECT_NEAR(estimate.effect.parameters[0].value, 0.5, 3 * estimate.sd[0]);
}

INSTANTIATE_TEST_SUITE_P(OfASkeleton, HiddenInLinks, testing::Values("shear"),
                         [](const auto& about) { return about.param; });

}  // namespace
}  // namespace palpate::identify
