#include "identify/diagnosis/verdict/verdict.h"

#include "identify/diagnosis/statistics/chance.h"
#include "tests/identify/diagnosed.h"

namespace palpate::identify {
namespace {

// What is a claim, and what is none.

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;

/// As if what was taken off for the mesh had been what the leading explanation explains, probe by probe.
void take_off_what_is_explained(Diagnosis& found) {
    found.problem.discretisation =
        (found.baseline.error - found.tried.front().fit.error).cwiseProduct(found.problem.sigma);
}

TEST_F(Diagnosed, WhatErrorsOfTheMeshMayFeignIsNoClaim) {
    // A support that yields by less than the noise: there is evidence for it, and noise is left without it, too.
    const MeasurementSet set = twin(truth("compliant-support", numbers({1.7, 0})));
    DiagnoseOptions options;
    options.law = neo_hookean;
    options.mesh_error = 0.001;
    Diagnosis found = diagnose(set, options);
    ASSERT_LT(found.baseline.whitened_rms, options.most_left(found.problem.rows()));
    EXPECT_THAT(found.explanation, ElementsAre("compliant-support"));
    found.tried = {*found.explained};
    // A skeleton does not tell of its error: a share of the displacement counts.
    DiagnoseOptions coarse = options;
    coarse.mesh_error = 0.01;
    decide_verdict(*model_, coarse, found);
    EXPECT_EQ(found.verdict, Verdict::adequate);
    take_off_what_is_explained(found);
    decide_verdict(*model_, options, found);
    EXPECT_EQ(found.verdict, Verdict::adequate);
    EXPECT_GT(candidate(found, "compliant-support").log_bayes_factor, options.least_evidence());
    EXPECT_THAT(candidate(found, "compliant-support").objection, HasSubstr("noise and discretisation error"));
    // Beside another effect no less is asked for. An effect that is unlike such errors needs no more for them.
    FittedExplanation &feigned = found.tried.front(), there = feigned;
    const double least = least_next_to_noise(feigned, found.problem, options);
    EXPECT_GT(least, options.idealisation_evidence);
    EXPECT_EQ(least_next_to_effect(feigned, there, found.problem, options), least);
    feigned.effects = {find_effect("gravity")};
    EXPECT_EQ(least_next_to_noise(feigned, found.problem, options), 2 * options.least_evidence());
    EXPECT_EQ(least_next_to_effect(feigned, there, found.problem, options), options.idealisation_evidence);
}

TEST_F(Diagnosed, LittleNextToWhatErrorsOfTheMeshFeignIsNothing) {
    const MeasurementSet set = twin(truth("compliant-support", numbers({1.7, 0})));
    DiagnoseOptions options;
    options.law = neo_hookean;
    options.mesh_error = 0.001;
    Diagnosis found = diagnose(set, options);
    ASSERT_TRUE(found.explained);
    FittedExplanation feigned = *found.explained, other = *found.explained;
    found.tried = {feigned};
    take_off_what_is_explained(found);
    feigned.log_bayes_factor = 50;
    other.effects = {find_effect("gravity")};
    const auto verdict = [&](double evidence) {
        other.log_bayes_factor = evidence;
        found.tried = {feigned, other};
        decide_verdict(*model_, options, found);
        EXPECT_THAT(found.tried.front().objection, HasSubstr("noise and discretisation error"));
        EXPECT_EQ(found.tried.back().objection, "");
        return found.verdict;
    };
    EXPECT_EQ(verdict(24), Verdict::adequate);
    EXPECT_EQ(verdict(40), Verdict::unexplained);
}

TEST_F(Diagnosed, WhatLeavesTooMuchIsNoClaim) {
    // of a clear case, as if meshes had left so much; with evidence all the same
    Diagnosis found = diagnose(twin(truth("gravity", half_g)));
    ASSERT_TRUE(found.explained);
    found.tried = {*found.explained};
    found.baseline.nuisance_pull = 0;
    const auto verdict = [&](double before, double after) {
        found.explanation.clear();
        found.explained.reset();
        found.baseline.whitened_rms = before;
        found.tried.front().fit.whitened_rms = after;
        decide_verdict(*model_, {}, found);
        return found.verdict;
    };
    EXPECT_EQ(verdict(1.08, 1.05), Verdict::missing_effect);  // 648 rows may leave 1.03 by chance
    EXPECT_EQ(verdict(1.09, 1.07), Verdict::adequate);
    EXPECT_EQ(verdict(1.12, 1.09), Verdict::unexplained);
    EXPECT_THAT(found.tried.front().objection, HasSubstr("too much of the misfit"));
    EXPECT_EQ(verdict(1.12, 1.04), Verdict::missing_effect);
}

TEST_F(Diagnosed, WhatBendsToEachProbeIsNoClaim) {
    Diagnosis found = diagnose(twin(truth("gravity", half_g)));
    ASSERT_TRUE(found.explained);
    EXPECT_LT(found.explained->held_out.whitened_rms, 1.03 * found.explained->fit.whitened_rms);
    found.tried = {*found.explained};
    found.tried.front().fit.whitened_rms = 1;
    const auto verdict = [&](double gap) {
        found.explanation.clear();
        found.explained.reset();
        found.tried.front().held_out.whitened_rms = gap;
        decide_verdict(*model_, {}, found);
        return found.verdict;
    };
    const DiagnoseOptions options;
    const double most = std::max(1 + options.noise_accuracy,
                                 largest_held_out(found.problem, found.tried.front().fit, options.false_refusals));
    EXPECT_LT(most, 1.13);  // 648 rows, and four sigma
    EXPECT_EQ(verdict(most - 0.01), Verdict::missing_effect);
    EXPECT_EQ(found.tried.front().objection, "");
    EXPECT_EQ(verdict(most + 0.01), Verdict::unexplained);
    EXPECT_THAT(found.tried.front().objection, HasSubstr("held-out probes"));
}

/// A clear case judged once more, with one thing about it changed.
class JudgedAgain : public Diagnosed {
protected:
    JudgedAgain() {
        found_ = diagnose(twin(truth("gravity", half_g)));
        found_.tried = {found_.explained.value()};
    }
    Verdict verdict() {
        found_.explanation.clear();
        found_.explained.reset();
        decide_verdict(*model_, {}, found_);
        return found_.verdict;
    }
    Diagnosis found_;
};

TEST_F(JudgedAgain, ItIsAClaim) { EXPECT_EQ(verdict(), Verdict::missing_effect); }

TEST_F(JudgedAgain, AsManyNumbersAsIndependentReadingsAreNone) {
    found_.independent = 6;  // stiffness, ratio and gravity's three
    EXPECT_EQ(verdict(), Verdict::missing_effect);
    found_.independent = 5;
    EXPECT_EQ(verdict(), Verdict::unexplained);
    EXPECT_THAT(found_.tried.front().objection, HasSubstr("5 parameters for 5 independent readings"));
}

TEST_F(JudgedAgain, WhatMakesProbesLeftOutWorseIsNone) {
    found_.baseline_held_out.rms_mm = 0.9 * found_.tried.front().held_out.rms_mm;
    EXPECT_EQ(verdict(), Verdict::unexplained);
    EXPECT_THAT(found_.tried.front().objection, HasSubstr("predicted worse with it"));
}

/// Of a probe that is left out, the spread of such a fault alone is known: millimetres are no measure of it.
TEST_F(JudgedAgain, AFaultOfTheMeasurementIsJudgedByNormalisedErrors) {
    found_ = diagnose(twin(truth("misalignment", numbers({1, -1, 1, 0.3, -0.3, 0.3}))));
    ASSERT_THAT(found_.explanation, ElementsAre("misalignment"));
    found_.tried = {found_.explained.value()};
    found_.baseline_held_out.rms_mm = 0.9 * found_.tried.front().held_out.rms_mm;
    ASSERT_GT(found_.baseline_held_out.whitened_rms, found_.tried.front().held_out.whitened_rms);
    EXPECT_EQ(verdict(), Verdict::missing_effect);
    found_.baseline_held_out.whitened_rms = 0.9 * found_.tried.front().held_out.whitened_rms;
    EXPECT_EQ(verdict(), Verdict::unexplained);
    EXPECT_THAT(found_.tried.front().objection, HasSubstr("predicted worse with it"));
}

TEST_F(JudgedAgain, WithoutAnyLawOfLargeDeformationItIsNone) {
    found_.large_deformation_failed = true;
    EXPECT_EQ(verdict(), Verdict::unexplained);
    EXPECT_TRUE(found_.explanation.empty());
    EXPECT_THAT(found_.notes, Contains(HasSubstr("no large-deformation law")));
}

TEST_F(JudgedAgain, BeneathALeaderThatCouldNotBeFittedItIsNone) {
    Candidate leader{.effect = find_effect("contact"), .log_bayes_factor = 1e7, .is_unfitted = true};
    found_.ranking.push_back(leader);
    EXPECT_EQ(verdict(), Verdict::unexplained);
    EXPECT_EQ(found_.ranking.front().effect->name(), "contact");  // and it is shown
}

TEST_F(Diagnosed, OneMarkerUnderOneLoadNamesNothing) {
    MeasurementSet set = twin(truth("gravity", half_g));
    const int kept = set.states[1].probe;
    std::erase_if(set.states, [&](const LoadState& state) { return state.probe != kept; });
    for (LoadState& state : set.states)
        std::erase_if(state.readings, [](const Reading& reading) { return reading.marker != 0; });
    const Diagnosis found = diagnose(set);
    EXPECT_LE(found.independent, 3);
    EXPECT_TRUE(found.explanation.empty());
}

TEST(Judge, AsksForMoreBesideWhatFlows) {
    Problem problem;
    problem.measured = problem.sigma = Eigen::VectorXd::Ones(0);
    const DiagnoseOptions options;
    const auto least_beside = [&](const char* name) {
        FittedExplanation there;
        there.effects = {find_effect(name)};
        there.log_bayes_factor = 1e6;
        return least_next_to_effect(*find_effect("gravity"), there, problem, options);
    };
    EXPECT_DOUBLE_EQ(least_beside("viscosity"), 500);
    EXPECT_DOUBLE_EQ(least_beside("plasticity"), 3000);
}

}  // namespace
}  // namespace palpate::identify
