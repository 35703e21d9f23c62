#include "identify/diagnosis/diagnose.h"

#include <functional>

#include "identify/diagnosis/statistics/chance.h"
#include "identify/diagnosis/verdict/verdict.h"
#include "tests/identify/diagnosed.h"
#include "tests/messages.h"

// What a diagnosis is told, what it is not, and what it refuses.

namespace palpate::identify {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;

class WithACrushingProbe : public Diagnosed {
protected:
    /// A ninth probe between the first and the second, which presses the bar lengthwise with a hundred times its
    /// modulus, and reads what a linear body would show.
    WithACrushingProbe() {
        set_ = twin(truth());
        std::vector<LoadState> crushing{
            LoadState{.probe = 9, .time = 1, .contacts = {{Vec3(40, 5, 5), Vec3(-1000, 0, 0), 3}}}};
        set_.states.insert(set_.states.begin() + 2,
                           make_twin(*model_, body_.set(crushing), truth(0), sigma).states.front());
    }
    MeasurementSet set_;
};

TEST_F(WithACrushingProbe, ItIsLeftOut) {
    const Diagnosis found = diagnose(set_);
    EXPECT_THAT(found.notes, Contains(HasSubstr("Probe 9 presses")));
    EXPECT_EQ(found.problem.readings(), 216);
    EXPECT_THAT(found.problem.probe, testing::Not(Contains(9)));
    EXPECT_EQ(found.verdict, Verdict::adequate);
}

TEST_F(WithACrushingProbe, OutliersAreNumberedAsTheSetsReadings) {
    set_.states[4].readings[5].position += 20 * sigma * Vec3(1, -1, 1);
    EXPECT_THAT(diagnose(set_).outliers.readings, ElementsAre(4 * 24 + 5));
}

TEST(DiagnoseOptions, TheLeastEvidenceFollowsFromTheRateOfFalseClaims) {
    DiagnoseOptions options;
    const auto effects = static_cast<double>(catalogue().size());
    EXPECT_DOUBLE_EQ(options.least_evidence(), std::log(effects / 1e-3));
    options.false_claims = 1e-6;
    options.without = {"gravity"};
    EXPECT_DOUBLE_EQ(options.least_evidence(), std::log((effects - 1) / 1e-6));
    options.false_claims = 0;
    EXPECT_THAT(message_of<InvalidInput>([&] { options.validate(); }), HasSubstr("false_claims is 0"));
}

TEST_F(Diagnosed, UnknownNoiseIsEstimated) {
    for (const std::uint64_t seed : {1, 2, 3, 4}) {
        MeasurementSet set = twin(truth(), sigma, seed);
        set.position_noise.reset();
        const Diagnosis found = diagnose(set);
        EXPECT_FALSE(found.noise_known);
        EXPECT_NEAR(found.noise / sigma, 1, 0.15) << seed;  // four sigma of a median of 216
        EXPECT_EQ(found.verdict, Verdict::adequate);
        EXPECT_THAT(found.notes, Contains(HasSubstr("does not tell its noise")));
    }
}

TEST_F(Diagnosed, UnknownNoiseIsEstimatedNextToAMissingEffect) {
    for (const std::uint64_t seed : {1, 2}) {
        MeasurementSet set = twin(truth("gravity", half_g), sigma, seed);
        set.position_noise.reset();
        const Diagnosis found = diagnose(set);
        EXPECT_THAT(found.explanation, ElementsAre("gravity"));
        EXPECT_NEAR(found.noise / sigma, 1, 0.15) << seed;  // as above
    }
}

TEST_F(Diagnosed, ASigmaThatAReadingTellsStays) {
    MeasurementSet set = twin(truth());
    set.position_noise.reset();
    for (LoadState& state : set.states) {
        for (std::size_t r = 0; r < 12; ++r) state.readings[r].sigma = sigma;
    }
    const Diagnosis found = diagnose(set);
    for (Eigen::Index n = 0; n < found.problem.rows(); ++n) {
        if (found.problem.coordinate[n] / 3 >= 12) continue;
        ASSERT_EQ(found.problem.sigma[n], sigma) << n;
    }
}

TEST_F(Diagnosed, EffectsThatAreKnownAreInEveryExplanation) {
    DiagnoseOptions options;
    options.known = {{"gravity", {{"gz", -3000, "mm/s^2"}}}};
    const Diagnosis found = diagnose(twin(truth("gravity", half_g)), options);
    EXPECT_EQ(found.verdict, Verdict::adequate);
    ASSERT_EQ(found.baseline.explanation.effects.size(), 1u);
    EXPECT_NEAR(found.baseline.explanation.values[0][2], half_g.z(), 0.03);  // fitted anew, 4 sd
    for (const Candidate& c : found.ranking) EXPECT_NE(c.effect->name(), "gravity");
}

TEST_F(Diagnosed, WithoutTheScreenOnlyTheBaselineIsFitted) {
    DiagnoseOptions options;
    options.screen = false;
    const Diagnosis found = diagnose(twin(truth("gravity", half_g)), options);
    EXPECT_EQ(found.verdict, Verdict::unexplained);
    for (const Candidate& c : found.ranking) EXPECT_FALSE(c.refit);
}

TEST_F(Diagnosed, WhatErrorsOfTheMeshMayFeignIsNoClaim) {
    // A support that yields by less than the noise: there is evidence for it, and noise is left without it, too.
    const MeasurementSet set = twin(truth("compliant-support", numbers({1.7, 0})));
    DiagnoseOptions exact, coarse;
    exact.law = coarse.law = neo_hookean;
    exact.mesh_error = 0.001;
    coarse.mesh_error = 0.01;
    const Diagnosis claimed = diagnose(set, exact), not_claimed = diagnose(set, coarse);
    ASSERT_LT(claimed.baseline.whitened_rms, exact.most_left(claimed.problem.rows()));
    EXPECT_THAT(claimed.explanation, ElementsAre("compliant-support"));
    EXPECT_EQ(not_claimed.verdict, Verdict::adequate);
    EXPECT_GT(candidate(not_claimed, "compliant-support").log_bayes_factor, coarse.least_evidence());
    EXPECT_THAT(candidate(not_claimed, "compliant-support").objection, HasSubstr("errors of mesh and rig"));
}

TEST_F(Diagnosed, LittleNextToWhatErrorsOfTheMeshFeignIsNothing) {
    const MeasurementSet set = twin(truth("compliant-support", numbers({1.7, 0})));
    DiagnoseOptions options;
    options.law = neo_hookean;
    options.mesh_error = 0.01;
    Diagnosis found = diagnose(set, options);
    ASSERT_EQ(found.verdict, Verdict::adequate);
    const auto own =
        std::ranges::find_if(found.tried, [](const FittedExplanation& e) { return e.has("compliant-support"); });
    ASSERT_NE(own, found.tried.end());
    FittedExplanation feigned = *own, other = *own;
    options.mesh_error = 0.05;
    feigned.log_bayes_factor = 50;
    other.effects = {find_effect("gravity")};
    const auto verdict = [&](double evidence) {
        other.log_bayes_factor = evidence;
        found.tried = {feigned, other};
        decide_verdict(*model_, options, found);
        EXPECT_THAT(found.tried.front().objection, HasSubstr("errors of mesh and rig"));
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

TEST(MostLeft, IsWhatNoiseIsToldToOrWhatChanceLeaves) {
    DiagnoseOptions options;
    EXPECT_DOUBLE_EQ(options.most_left(10000), 1.1);
    EXPECT_NEAR(options.most_left(60), std::sqrt(99.607 / 60), 1e-4);  // chi^2 of 60 that 0.001 exceed
    options.noise_accuracy = 0.5;
    EXPECT_DOUBLE_EQ(options.most_left(60), 1.5);
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

TEST_F(Diagnosed, NumbersDoNotDependOnThreads) {
    const MeasurementSet set = twin(truth("gravity", half_g));
    DiagnoseOptions one, two;
    two.refit.threads = 2;
    const Diagnosis a = diagnose(set, one), b = diagnose(set, two);
    EXPECT_EQ(a.baseline.log_evidence, b.baseline.log_evidence);
    EXPECT_EQ(a.law_evidence, b.law_evidence);
    ASSERT_EQ(a.ranking.size(), b.ranking.size());
    for (std::size_t c = 0; c < a.ranking.size(); ++c) {
        EXPECT_EQ(a.ranking[c].effect->name(), b.ranking[c].effect->name());
        EXPECT_EQ(a.ranking[c].screened, b.ranking[c].screened);
        EXPECT_EQ(a.ranking[c].log_bayes_factor, b.ranking[c].log_bayes_factor);
        EXPECT_EQ(a.ranking[c].estimate.sd, b.ranking[c].estimate.sd);
    }
    EXPECT_EQ(a.best().explanation.all(), b.best().explanation.all());
    EXPECT_EQ(a.best().residual, b.best().residual);
}

TEST_F(Diagnosed, TakesProbesThatReadOneCoordinateOnly) {
    MeasurementSet set = twin(truth("gravity", half_g));
    for (LoadState& state : set.states) {
        for (Reading& reading : state.readings) reading.position.head<2>().setConstant(missing);
    }
    const Diagnosis found = diagnose(set);
    EXPECT_THAT(found.explanation, Contains("gravity"));
    EXPECT_EQ(found.problem.rows(), 216);
}

TEST_F(Diagnosed, MessagesNameOptionValueAndBound) {
    const auto message = [&](const std::function<void(DiagnoseOptions&)>& change) {
        DiagnoseOptions options;
        change(options);
        return message_of([&] { options.validate(); });
    };
    EXPECT_EQ(message([](DiagnoseOptions& o) { o.refits = 0; }), "refits is 0; allowed: 1 and more");
    EXPECT_EQ(message([](DiagnoseOptions& o) { o.most_pull = 0; }), "most_pull is 0; it must be above 0");
    EXPECT_EQ(message([](DiagnoseOptions& o) { o.false_refusals = 0; }),
              "false_refusals is 0; allowed: above 0 and below 1");
    EXPECT_THAT(message([](DiagnoseOptions& o) { o.noise_accuracy = missing; }), HasSubstr("noise_accuracy is nan"));
    EXPECT_EQ(message([](DiagnoseOptions& o) { o.mesh_error = -1; }), "mesh_error is -1; it must be 0 or more");
    EXPECT_THAT(message([](DiagnoseOptions& o) { o.without = {"gravty"}; }),
                HasSubstr("effect 'gravty' is not known (did you mean 'gravity'?)"));
    EXPECT_THAT(message([](DiagnoseOptions& o) { o.refit.steps = 0; }), HasSubstr("steps is 0"));
    EXPECT_EQ(message([](DiagnoseOptions&) {}), "");
}

TEST_F(Diagnosed, AKnownEffectThatIsNoneIsRefused) {
    DiagnoseOptions options;
    options.known = {{"gravty", {}}};
    EXPECT_THAT(message_of([&] { diagnose(twin(truth()), options); }), HasSubstr("did you mean 'gravity'?"));
}

TEST_F(Diagnosed, ALawThatTheModelLacksIsRefused) {
    DiagnoseOptions options;
    options.law = 7;
    EXPECT_THAT(message_of([&] { diagnose(twin(truth()), options); }), HasSubstr("law is 7"));
}

TEST_F(Diagnosed, ASetWithoutLabelledReadingsIsRefused) {
    MeasurementSet set = twin(truth());
    for (LoadState& state : set.states) state.readings.clear();
    EXPECT_THAT(message_of([&] { diagnose(set); }), HasSubstr("has no labelled reading"));
}

TEST_F(Diagnosed, LoadsThatNoBodyBearsAreAFailureThatIsSaid) {
    // Loads of another unit, a million times too large: a body that stiff is beyond what is believed.
    MeasurementSet set = twin(truth());
    for (LoadState& state : set.states) {
        for (mesh::Contact& contact : state.contacts) contact.force *= 1e9;
        for (Reading& reading : state.readings) reading.position = body_.markers[reading.marker].rest;
    }
    DiagnoseOptions options;
    options.law = neo_hookean;
    EXPECT_THROW(diagnose(set, options), SolverFailure);
}

}  // namespace
}  // namespace palpate::identify
