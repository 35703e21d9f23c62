#include "identify/diagnosis/ladder/ladder.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "identify/comparison/compare.h"
#include "identify/diagnosis/diagnose.h"
#include "identify/effects/catalogue.h"
#include "mesh/errors.h"
#include "skeleton/model/state.h"
#include "tests/identify/diagnosis/ladder/ladder_fixture.h"
#include "tests/messages.h"

namespace palpate::identify {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

TEST_F(LadderTest, GravityLowersTheErrorOnFittedAndOnHeldOutProbes) {
    const Ladder ladder = build_ladder(twin({{"gravity", half_g_}}), {"gravity"});
    ASSERT_EQ(ladder.steps.size(), 2u);
    const LadderStep &bare = ladder.steps[0], &with_gravity = ladder.steps[1];
    EXPECT_THAT(bare.effects, IsEmpty());
    EXPECT_THAT(names_of(with_gravity.effects), ElementsAre("gravity"));

    // The reference body is left with the noise, the chain with its own coarseness.
    ASSERT_TRUE(bare.reference && with_gravity.reference);
    EXPECT_LT(with_gravity.reference->rms_mm, 0.15 * bare.reference->rms_mm);
    EXPECT_LT(with_gravity.reference->held_out_rms_mm, 0.15 * bare.reference->held_out_rms_mm);
    EXPECT_NEAR(with_gravity.reference->whitened_rms, 1, 4 / std::sqrt(2 * 648.0));  // 4 sigma
    EXPECT_NEAR(with_gravity.reference->held_out_whitened_rms, 1, 4 / std::sqrt(2 * 648.0));
    EXPECT_LT(with_gravity.skeleton.rms_mm, 0.5 * bare.skeleton.rms_mm);
    EXPECT_LT(with_gravity.skeleton.held_out_rms_mm, 0.7 * bare.skeleton.held_out_rms_mm);
    EXPECT_GT(with_gravity.log_evidence, bare.log_evidence + 1000);
    EXPECT_EQ(ladder.verdict, Verdict::adequate);
    // All probes are held out in turn, so the last step is the model that is delivered, and compared.
    EXPECT_EQ(with_gravity.skeleton.rms_mm, with_gravity.comparison.rms);
    EXPECT_EQ(with_gravity.reference->rms_mm, ladder.whole.best().rms_mm);
    EXPECT_EQ(with_gravity.validation_model.links.front().stiffness, with_gravity.model.links.front().stiffness);

    // Each step tells the material that its own fit comes to.
    const MaterialEstimate told = material_of(*reference_, ladder.whole.best());
    EXPECT_EQ(with_gravity.material.young, told.young);
    EXPECT_GT(told.young_sd, 0);
    EXPECT_LT(told.young_sd, 0.05 * told.young);
    EXPECT_NEAR(told.young, 0.3, 4 * told.young_sd);  // the body's, within 4 sd
    EXPECT_NE(bare.material.young, told.young) << "without gravity it is another";
}

TEST_F(LadderTest, TheModelHoldsTheEffect) {
    const MeasurementSet set = twin({{"gravity", half_g_}});
    const Ladder ladder = build_ladder(set, {"gravity"});
    EXPECT_THAT(ladder.steps[0].model.effects, IsEmpty());
    const skeleton::Model& model = ladder.steps[1].model;
    ASSERT_THAT(names_of(model.effects), ElementsAre("gravity"));
    EXPECT_NEAR(model.effects[0].parameters[2].value, 9810 * half_g_[2], 0.05 * 4905);  // 4 sd
    EXPECT_THAT(names_of(ladder.identified.model.effects), ElementsAre("gravity"));
    EXPECT_EQ(ladder.identified.posterior.size(), 3u);
    // the comparison is that of the model that is delivered, on all states
    EXPECT_EQ(ladder.steps[1].comparison.probes.size(), 9u);
    EXPECT_DOUBLE_EQ(compare(model, set).rms, ladder.steps[1].comparison.rms);
}

TEST_F(LadderTest, AMisalignmentIsTakenOutOfTheMeasurements) {
    const MeasurementSet set = twin({{"misalignment", moved_}}), straight = twin({});
    const Ladder ladder = build_ladder(set, {"misalignment"});
    // Readings stand where an aligned camera sees them, up to how well six numbers are known: under 0.01 mm.
    const MeasurementSet& corrected = ladder.steps[1].set;
    double worst = 0;
    for (std::size_t s = 0; s < set.states.size(); ++s) {
        EXPECT_EQ(ladder.steps[0].set.states[s].readings[3].position, set.states[s].readings[3].position);
        for (std::size_t r = 0; r < set.states[s].readings.size(); ++r) {
            worst = std::max(
                worst, (corrected.states[s].readings[r].position - straight.states[s].readings[r].position).norm());
        }
    }
    // the noise is turned with the frame: by 0.03 of it
    EXPECT_LT(worst, 0.02);
    // A model records it and plays without.
    EXPECT_THAT(names_of(ladder.steps[1].model.effects), ElementsAre("misalignment"));
    EXPECT_LT(ladder.steps[1].skeleton.rms_mm, 0.5 * ladder.steps[0].skeleton.rms_mm);
    EXPECT_LT(ladder.steps[1].skeleton.held_out_rms_mm, 0.5 * ladder.steps[0].skeleton.held_out_rms_mm);
}

TEST_F(LadderTest, EffectsComeOneByOne) {
    const Ladder ladder =
        build_ladder(twin({{"gravity", half_g_}, {"misalignment", moved_}}), {"misalignment", "gravity"});
    ASSERT_EQ(ladder.steps.size(), 3u);
    EXPECT_THAT(names_of(ladder.steps[1].effects), ElementsAre("misalignment"));
    EXPECT_THAT(names_of(ladder.steps[2].effects), ElementsAre("misalignment", "gravity"));
    for (int step : {1, 2}) {
        EXPECT_LT(ladder.steps[step].reference->rms_mm, ladder.steps[step - 1].reference->rms_mm);
        EXPECT_GT(ladder.steps[step].log_evidence, ladder.steps[step - 1].log_evidence);
    }
    EXPECT_LT(ladder.steps[2].reference->whitened_rms, 1.1);
    EXPECT_EQ(ladder.verdict, Verdict::adequate);
}

TEST_F(LadderTest, AnEffectThatIsThereTwiceIsAddedTwice) {
    const auto ball = [](double x, double ratio) { return numbers({x, 5, 5, std::log(6), std::log(ratio)}); };
    options_.start = {
        {"inclusion", {{"cx", 33, "mm"}, {"cy", 5, "mm"}, {"cz", 5, "mm"}, {"radius", 6, "mm"}, {"ratio", 4, "1"}}},
        {"inclusion", {{"cx", 20, "mm"}, {"cy", 5, "mm"}, {"cz", 5, "mm"}, {"radius", 6, "mm"}, {"ratio", 0.4, "1"}}}};
    const Ladder ladder =
        build_ladder(twin({{"inclusion", ball(34, 6)}, {"inclusion", ball(20, 1 / 3.0)}}), {"inclusion", "inclusion"});
    ASSERT_EQ(ladder.steps.size(), 3u);
    ASSERT_THAT(names_of(ladder.steps[2].effects), ElementsAre("inclusion", "inclusion"));
    EXPECT_GT(ladder.steps[2].effects[0].parameters[4].value, 1);
    EXPECT_LT(ladder.steps[2].effects[1].parameters[4].value, 1);
    EXPECT_LT(ladder.steps[2].reference->rms_mm, ladder.steps[1].reference->rms_mm);
    EXPECT_LT(ladder.steps[1].reference->rms_mm, ladder.steps[0].reference->rms_mm);
}

TEST_F(LadderTest, OutliersAreLeftOutOfTheMeasurements) {
    MeasurementSet set = twin({{"gravity", half_g_}});
    const std::vector<int> off{10, 47, 100, 155, 180};
    for (const int i : off) set.states[i / 24].readings[i % 24].position += 20 * sigma * Vec3(1, -1, 1);
    const Ladder ladder = build_ladder(set, {"gravity", "outliers"});
    ASSERT_EQ(ladder.steps.size(), 3u);
    EXPECT_THAT(names_of(ladder.steps[2].effects), ElementsAre("gravity", "outliers"));
    std::size_t left = 0;
    for (const LoadState& state : ladder.steps[2].set.states) left += state.readings.size();
    EXPECT_EQ(left, 211u);
    EXPECT_LT(ladder.steps[2].reference->whitened_rms, 1.1);
    EXPECT_LT(ladder.steps[2].reference->held_out_whitened_rms, 1 + 4 / std::sqrt(2 * 633.0));  // 4 sigma
}

TEST_F(LadderTest, TheDiagnosisTellsWhatTheScreenExpected) {
    const MeasurementSet set = twin({{"gravity", half_g_}});
    const Diagnosis diagnosis = diagnose(*reference_, set, options_.diagnose);
    const Ladder ladder = identify::build_ladder(body_.chain(), *reference_, set, {"gravity"}, options_, &diagnosis);
    EXPECT_EQ(ladder.steps[1].predicted_rms_mm, diagnosis.ranking.front().predicted_rms_mm);
    EXPECT_TRUE(std::isnan(ladder.steps[0].predicted_rms_mm));
}

TEST_F(LadderTest, JudgedOnTheSkeletonItFindsTheEffectItself) {
    options_.diagnose.law.reset();
    const Ladder ladder =
        identify::build_ladder(body_.chain(), *body_.skeleton(), twin({{"gravity", half_g_}}), {"gravity"}, options_);
    ASSERT_EQ(ladder.steps.size(), 2u);
    EXPECT_FALSE(ladder.steps[1].reference);
    EXPECT_LT(ladder.steps[1].skeleton.rms_mm, 0.5 * ladder.steps[0].skeleton.rms_mm);
    EXPECT_THAT(names_of(ladder.steps[1].model.effects), ElementsAre("gravity"));
    EXPECT_NEAR(ladder.steps[1].model.effects[0].parameters[2].value, 9810 * half_g_[2], 0.1 * 4905);
}

TEST_F(LadderTest, HeldOutProbesAreAQuarterAndSpreadOrAllInTurn) {
    options_.diagnose.law = 0;
    const auto held_out = [&](int probes) {
        const Ladder ladder = build_ladder(
            make_twin(*reference_, body_.set(SmallBody::probes(0.01, probes)), bare_truth(*reference_, 0), sigma), {});
        EXPECT_EQ(std::isnan(ladder.steps[0].skeleton.held_out_rms_mm), ladder.held_out_probes.empty());
        return ladder.held_out_probes;
    };
    EXPECT_THAT(held_out(2), IsEmpty());  // none to spare
    EXPECT_THAT(held_out(3), ElementsAre(0, 1, 2, 3));
    EXPECT_THAT(held_out(8), ElementsAre(0, 1, 2, 3, 4, 5, 6, 7, 8));
    EXPECT_THAT(held_out(9), ElementsAre(3, 7));
    EXPECT_THAT(held_out(12), ElementsAre(3, 7, 11));
}

TEST_F(LadderTest, AQuarterOfManyProbesIsPredictedToTheNoise) {
    const Ladder ladder = build_ladder(twin({{"gravity", half_g_}}, 12), {"gravity"});
    const LadderStep &bare = ladder.steps[0], &with_gravity = ladder.steps[1];
    EXPECT_LT(with_gravity.reference->held_out_rms_mm, 0.15 * bare.reference->held_out_rms_mm);
    EXPECT_NEAR(with_gravity.reference->held_out_whitened_rms, 1, 4 / std::sqrt(2 * 216.0));  // 4 sigma of 3 x 72 rows
    EXPECT_LT(with_gravity.skeleton.held_out_rms_mm, 0.7 * bare.skeleton.held_out_rms_mm);
    EXPECT_EQ(with_gravity.comparison.probes.size(), 13u);  // the model that is delivered is of all
}

TEST_F(LadderTest, NoStepButTheFirstWithoutEffects) {
    options_.diagnose.law = 0;
    const Ladder ladder = build_ladder(
        make_twin(*reference_, body_.set(SmallBody::probes(0.01, 4)), bare_truth(*reference_, 0), sigma), {});
    ASSERT_EQ(ladder.steps.size(), 1u);
    EXPECT_EQ(ladder.verdict, Verdict::adequate);
    EXPECT_THAT(ladder.steps[0].model.effects, IsEmpty());
}

TEST_F(LadderTest, WhatWasNamedAndIsNotAddedIsStillMissing) {
    // Nothing is hidden: anisotropy overfits three probes, which hardly feel stiffening.
    const MeasurementSet set = twin({}, 3);
    Diagnosis diagnosis = diagnose(*reference_, set, options_.diagnose);
    diagnosis.explanation = {"anisotropy", "stiffening"};
    options_.only_better = true;
    const Ladder ladder =
        identify::build_ladder(body_.chain(), *reference_, set, diagnosis.explanation, options_, &diagnosis);
    ASSERT_EQ(ladder.not_added.size(), 1u);
    EXPECT_EQ(ladder.not_added[0].effect, "anisotropy");
    EXPECT_TRUE(says(ladder.not_added[0].why, {"held-out probes"}));
    EXPECT_THAT(names_of(ladder.steps.back().effects), ElementsAre("stiffening"));
    EXPECT_EQ(ladder.verdict, Verdict::missing_effect);
}

TEST_F(LadderTest, AnEffectThatNeedsAnotherIsAddedOnIt) {
    // Without gravity, fibres bend to what it does in the probes that are fitted: held-out probes are worse with them.
    options_.only_better = true;
    const MeasurementSet set = twin({{"anisotropy", numbers({1.5, 0.48, 0.6, 0.64})}, {"gravity", half_g_}}, 3);
    const std::vector<std::string> both{"anisotropy", "gravity"};
    Diagnosis diagnosis = diagnose(*reference_, set, options_.diagnose);
    const auto built = [&] {
        return identify::build_ladder(body_.chain(), *reference_, set, both, options_, &diagnosis);
    };
    diagnosis.explanation = {};
    const Ladder of_one = built();
    EXPECT_THAT(names_of(of_one.steps.back().effects), ElementsAre("gravity"));
    ASSERT_EQ(of_one.not_added.size(), 1u);
    EXPECT_EQ(of_one.not_added[0].effect, "anisotropy");

    diagnosis.explanation = both;
    const Ladder of_both = built();
    EXPECT_THAT(of_both.not_added, IsEmpty());
    ASSERT_EQ(of_both.steps.size(), 3u);
    EXPECT_THAT(names_of(of_both.steps[2].validation_model.effects), ElementsAre("gravity", "anisotropy"));
    EXPECT_LT(of_both.steps[2].reference->held_out_rms_mm, of_both.steps[1].reference->held_out_rms_mm);
    EXPECT_LT(of_both.steps[1].reference->held_out_rms_mm, of_both.steps[0].reference->held_out_rms_mm);
}

TEST_F(LadderTest, AnUnknownEffectIsRefused) { EXPECT_THROW(build_ladder(twin({}), {"gravty"}), InvalidInput); }

TEST_F(LadderTest, AnEffectThatCannotShowIsRefused) {
    EXPECT_TRUE(says(message_of<InvalidInput>([&] {
                         build_ladder(twin({}), {"gravity", "pressure"});
                     }),
                     {"'pressure'", "cannot show", "cavity"}));
    EXPECT_THROW(build_ladder(twin({}), {"shear"}), InvalidInput);  // no solid has it
}

TEST_F(LadderTest, WhatLinksAloneHaveIsAddedOnTheSkeletonItself) {
    options_.diagnose.law = 1;
    const auto skeleton = body_.skeleton();
    const Explanation truth = with(bare_truth(*skeleton, 1), find_effect("shear"), Eigen::VectorXd::Constant(1, 0.5));
    const MeasurementSet set = make_twin(*skeleton, body_.set(SmallBody::probes(0.05)), truth, sigma);
    const Ladder ladder = identify::build_ladder(body_.chain(), *skeleton, set, {"shear"}, options_);
    ASSERT_EQ(ladder.steps.size(), 2u);
    EXPECT_FALSE(ladder.steps[0].reference || ladder.steps[1].reference);
    EXPECT_THAT(names_of(ladder.steps[1].model.effects), ElementsAre("shear"));
    EXPECT_NEAR(ladder.steps[1].effects[0].parameters[0].value, 0.5, 0.1);
    EXPECT_GT(ladder.steps[0].skeleton.rms_mm, 1.2 * sigma);
    EXPECT_NEAR(ladder.steps[1].skeleton.rms_mm, sigma, 0.1 * sigma);
    EXPECT_LT(ladder.steps[1].skeleton.held_out_rms_mm, ladder.steps[0].skeleton.held_out_rms_mm);
    EXPECT_EQ(ladder.verdict, Verdict::adequate);
}

}  // namespace
}  // namespace palpate::identify
