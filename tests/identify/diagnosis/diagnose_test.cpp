#include "identify/diagnosis/diagnose.h"

#include <cmath>

#include "tests/identify/diagnosed.h"

// Twins: the reference body itself is the truth, so that nothing but the hidden effect and the noise is to be found.

namespace palpate::identify {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

TEST_F(Diagnosed, NoiseAloneIsAdequateAndNamesNothing) {
    for (const int law : {0, 1, neo_hookean}) {
        for (const std::uint64_t seed : {1, 2}) {
            const Diagnosis found = diagnose(twin(truth(law), sigma, seed));
            EXPECT_EQ(found.verdict, Verdict::adequate) << law;
            EXPECT_THAT(found.explanation, IsEmpty());
            for (const Candidate& c : found.ranking) EXPECT_LT(c.log_bayes_factor, 5) << c.effect->name();
            EXPECT_FALSE(found.next_probe);
            // of 648 rows: 4 sigma of chi^2, a nuisance of priors wider than the truth taking some of it
            EXPECT_NEAR(found.baseline.whitened_rms, 1, 4 / std::sqrt(2 * 648.0));
            EXPECT_NEAR(found.baseline.explanation.theta[0], std::log(SmallBody::young),
                        4 * std::sqrt(found.baseline.covariance(0, 0)));
            EXPECT_NEAR(found.noise, sigma, 1e-12);  // rounding
        }
    }
}

TEST_F(Diagnosed, TheLawIsThatOfTheTruthUpToWhatItMoves) {
    // Small strain is told from large; the two laws of large deformation differ by a few sigma at most.
    EXPECT_EQ(diagnose(twin(truth(0))).law, 0);
    for (const int law : {1, neo_hookean}) {
        const Diagnosis found = diagnose(twin(truth(law)));
        EXPECT_NE(found.law, 0);
        EXPECT_LT(found.law_evidence[0], -100);
    }
}

TEST_F(Diagnosed, GravityIsNamedWithItsSizeAndDirection) {
    for (const std::uint64_t seed : {1, 2, 3}) {
        DiagnoseOptions options;
        options.law = neo_hookean;  // St. Venant and Kirchhoff's is within one nat, and would bear some of gx
        const Diagnosis found = diagnose(twin(truth("gravity", half_g), sigma, seed), options);
        EXPECT_EQ(found.verdict, Verdict::missing_effect);
        EXPECT_THAT(found.explanation, ElementsAre("gravity"));
        const Candidate& gravity = found.ranking.front();
        EXPECT_GT(gravity.log_bayes_factor, 1000);
        EXPECT_GT(gravity.probability, 0.99);
        for (int axis = 0; axis < 3; ++axis) {
            EXPECT_NEAR(gravity.estimate.effect.parameters[axis].value, 9810 * half_g[axis],
                        3 * gravity.estimate.sd[axis])
                << seed;
        }
        EXPECT_LT(gravity.estimate.sd[2], 0.02 * 4905);
        EXPECT_LT(found.best().rms_mm, 0.1 * found.baseline.rms_mm);
        // the screen says beforehand what will be left
        EXPECT_NEAR(gravity.predicted_rms_mm, found.best().rms_mm, 0.3 * found.best().rms_mm);
        EXPECT_NEAR(gravity.held_out->whitened_rms, 1, 4 / std::sqrt(2 * 648.0));  // 4 sigma
    }
}

TEST_F(Diagnosed, GravityHasTheEarthsSizeWhereTheReadingsAllowIt) {
    DiagnoseOptions weighed;
    weighed.refit.magnitude = MagnitudeUse::alternative;
    const auto size = [](const Candidate& c) {
        return Vec3(estimate(c, "gx"), estimate(c, "gy"), estimate(c, "gz")).norm();
    };
    // Along the bar it hardly shows under such noise: the free fit is off there by more than the earth's varies.
    const Vec3 towards = Vec3(-0.5, 0.1, -0.85).normalized();
    const MeasurementSet set = twin(truth("gravity", numbers({towards.x(), towards.y(), towards.z()})), 10 * sigma);
    const Candidate free = candidate(diagnose(set), "gravity"), on_earth = candidate(diagnose(set, weighed), "gravity");
    EXPECT_GT(std::abs(size(free) - 9810), 60);
    EXPECT_NEAR(size(on_earth), 9800, 1);
    EXPECT_GT(on_earth.log_bayes_factor, free.log_bayes_factor);
    for (int axis = 0; axis < 3; ++axis) {
        EXPECT_NEAR(on_earth.estimate.effect.parameters[axis].value, 9810 * towards[axis],
                    3 * on_earth.estimate.sd[axis]);
        EXPECT_LT(on_earth.estimate.sd[axis], 1.1 * free.estimate.sd[axis]);
    }

    // Half of it is not the earth's: nothing changes but that it was possible.
    const MeasurementSet half = twin(truth("gravity", half_g));
    const Candidate by_itself = candidate(diagnose(half), "gravity"),
                    weighted = candidate(diagnose(half, weighed), "gravity");
    EXPECT_NEAR(size(weighted), size(by_itself), 1e-6 * 9810);
    EXPECT_NEAR(by_itself.log_bayes_factor - weighted.log_bayes_factor, std::log(2), 1e-6);

    weighed.refit.magnitude = MagnitudeUse::certain;
    EXPECT_NEAR(size(candidate(diagnose(set, weighed), "gravity")), 9800, 1);
}

TEST_F(Diagnosed, GravityIsNamedWhateverTheLaw) {
    const Diagnosis found = diagnose(twin(truth("gravity", half_g)));
    EXPECT_EQ(found.verdict, Verdict::missing_effect);
    EXPECT_THAT(found.explanation, ElementsAre("gravity"));
    EXPECT_NEAR(estimate(found.ranking.front(), "gz"), 9810 * half_g.z(), 3 * found.ranking.front().estimate.sd[2]);
}

TEST_F(Diagnosed, NoisierGravityIsNamed) {
    for (const double noise : {0.05, 0.1, 0.2}) {
        const Diagnosis found = diagnose(twin(truth("gravity", half_g), noise));
        EXPECT_THAT(found.explanation, Contains("gravity")) << noise;
    }
}

TEST_F(Diagnosed, ACompliantSupportIsNamedWithItsStiffness) {
    const Diagnosis found = diagnose(twin(truth("compliant-support", numbers({std::log(2.0), 0}))));
    EXPECT_EQ(found.verdict, Verdict::missing_effect);
    EXPECT_THAT(found.explanation, ElementsAre("compliant-support"));
    EXPECT_NEAR(estimate(found.ranking.front(), "stiffness"), 2, 3 * found.ranking.front().estimate.sd[0]);
    EXPECT_LT(found.ranking.front().estimate.sd[0], 0.2);
}

TEST_F(Diagnosed, AMisalignmentIsNamedWithItsSixNumbers) {
    const Eigen::VectorXd moved = numbers({0.3, -0.2, 0.1, 0.01, -0.015, 0.02});
    const Diagnosis found = diagnose(twin(truth("misalignment", moved)));
    EXPECT_EQ(found.verdict, Verdict::missing_effect);
    EXPECT_THAT(found.explanation, ElementsAre("misalignment"));
    const Candidate& first = found.ranking.front();
    for (int j = 0; j < 6; ++j)
        EXPECT_NEAR(first.estimate.effect.parameters[j].value, moved[j], 3.5 * first.estimate.sd[j]) << j;
}

TEST_F(Diagnosed, ForceGainsAreNamedProbeByProbe) {
    const Eigen::VectorXd gains = numbers({0.2, -0.15, 0.3, -0.25, 0.1, -0.2, 0.15, -0.1});
    const Diagnosis found = diagnose(twin(truth("force-gain", gains)));
    EXPECT_EQ(found.verdict, Verdict::missing_effect);
    EXPECT_THAT(found.explanation, ElementsAre("force-gain"));
    const Candidate& first = found.ranking.front();
    ASSERT_EQ(first.estimate.effect.parameters.size(), 8u);
    for (int j = 0; j < 8; ++j) {
        EXPECT_NEAR(std::log(first.estimate.effect.parameters[j].value), gains[j],
                    3.5 * first.estimate.sd[j] / first.estimate.effect.parameters[j].value)
            << j;
    }
}

TEST_F(Diagnosed, OutliersAreNamedAndSetAside) {
    const std::vector<int> off{10, 47, 100, 130, 180};
    MeasurementSet set = twin(truth());
    for (const int i : off) set.states[i / 24].readings[i % 24].position += 15 * sigma * Vec3(1, -1, 1);
    const Diagnosis found = diagnose(set);
    EXPECT_EQ(found.verdict, Verdict::missing_effect);
    EXPECT_THAT(found.explanation, ElementsAre("outliers"));
    EXPECT_EQ(found.outliers.readings, off);
    EXPECT_EQ(found.problem.readings(), 211);
    EXPECT_EQ(estimate(found.ranking.front(), "readings"), 5);
    EXPECT_NEAR(estimate(found.ranking.front(), "share"), 5.0 / 216, 1e-12);
    EXPECT_LT(found.baseline.whitened_rms, 1.1);
    EXPECT_THAT(found.notes, Contains(HasSubstr("5 of 216 readings")));

    DiagnoseOptions options;
    options.without = {"outliers"};
    EXPECT_THAT(diagnose(set, options).outliers.readings, IsEmpty());
}

TEST_F(Diagnosed, OutliersNextToGravityAreBothNamed) {
    const std::vector<int> off{10, 47, 100, 130, 180};
    MeasurementSet set = twin(truth("gravity", half_g));
    for (const int i : off) set.states[i / 24].readings[i % 24].position += 20 * sigma * Vec3(1, -1, 1);
    const Diagnosis found = diagnose(set);
    EXPECT_EQ(found.verdict, Verdict::missing_effect);
    EXPECT_THAT(found.explanation, ElementsAre("gravity", "outliers"));
    EXPECT_EQ(found.outliers.readings, off);
    EXPECT_LT(found.best().whitened_rms, 1.1);
}

TEST_F(Diagnosed, WhatTheCatalogueLacksIsNotExplainedOrByAStatedAlias) {
    int aliases = 0;
    const auto check = [&](const std::string& effect, const Eigen::VectorXd& values) {
        DiagnoseOptions options;
        options.without = {effect};
        const Diagnosis found = diagnose(twin(truth(effect, values)), options);
        for (const Candidate& c : found.ranking) EXPECT_NE(c.effect->name(), effect);
        if (found.verdict == Verdict::unexplained) {
            EXPECT_THAT(found.explanation, IsEmpty());
            // no wrong effect leaves noise only
            EXPECT_GT(found.best().whitened_rms, options.most_left(found.problem.rows()));
        } else {  // as a soft ball at the base does for springs below it
            EXPECT_EQ(found.verdict, Verdict::missing_effect) << effect;
            EXPECT_THAT(find_effect(effect)->description().confused_with, Contains(found.explanation.front()));
            ++aliases;
        }
        EXPECT_THAT(found.outliers.readings, IsEmpty()) << effect;
    };
    check("gravity", half_g);
    check("compliant-support", numbers({std::log(2.0), 0}));
    check("misalignment", numbers({0.3, -0.2, 0.1, 0.01, -0.015, 0.02}));
    check("force-gain", numbers({0.2, -0.15, 0.3, -0.25, 0.1, -0.2, 0.15, -0.1}));
    EXPECT_LE(aliases, 1);
}

TEST_F(Diagnosed, AClaimLeavesNoiseOnly) {
    // What looks like another effect is one only where it leaves noise: a turned frame that mimics a weight.
    const Eigen::VectorXd like_weight = numbers({-0.002, -0.12, -0.4, 0.0004, 0.0206, -0.0064});
    for (const double size : {0.1, 0.6, 2.0}) {
        const Diagnosis found = diagnose(twin(truth("misalignment", size * like_weight), 0.05));
        if (found.verdict == Verdict::missing_effect || found.verdict == Verdict::ambiguous) {
            EXPECT_LT(found.best().whitened_rms, 1.1) << size;
        }
    }
}

TEST_F(Diagnosed, AFrameTurnedAsAWeightWouldTurnItIsAmbiguous) {
    // The six numbers of the best misalignment of a body under its weight. At 5 times the noise the fit of three
    // numbers that is a little worse is worth as much as that of six.
    const Eigen::VectorXd like_weight = numbers({-0.002, -0.12, -0.4, 0.0004, 0.0206, -0.0064});
    const Diagnosis found = diagnose(twin(truth("misalignment", 0.58 * like_weight), 0.05));
    EXPECT_EQ(found.verdict, Verdict::ambiguous);
    const std::vector<std::string> first{found.ranking[0].effect->name(), found.ranking[1].effect->name()};
    EXPECT_THAT(first, testing::UnorderedElementsAre("gravity", "misalignment"));
    ASSERT_TRUE(found.next_probe);
    // A frame is turned for points that stand still, too, and a weight turns against the body.
    EXPECT_THAT(found.next_probe->kind, testing::AnyOf("fiducials", "orientation"));
    EXPECT_GT(found.next_probe->sigmas, 3);
    EXPECT_THAT(found.next_probe->why, HasSubstr("separates"));
}

TEST_F(Diagnosed, AnEffectThatIsTooWeakIsNotClaimed) {
    const Diagnosis found = diagnose(twin(truth("gravity", 0.03 * half_g)));
    EXPECT_NE(found.verdict, Verdict::unexplained);
    for (const std::string& name : found.explanation) EXPECT_EQ(name, "gravity");
    EXPECT_EQ(found.explanation.empty(), candidate(found, "gravity").log_bayes_factor < 10);
}

TEST_F(Diagnosed, ProbabilitiesAddUpToOneWithThatOfNothing) {
    for (const Explanation& hidden : {truth(), truth("gravity", 0.05 * half_g)}) {
        const Diagnosis found = diagnose(twin(hidden));
        double all = 0, odds = 1;
        for (const Candidate& c : found.ranking) {
            all += c.probability;
            odds += std::exp(c.log_bayes_factor);
        }
        EXPECT_NEAR(all, 1 - 1 / odds, 1e-9);
        EXPECT_TRUE(std::ranges::is_sorted(found.ranking, std::greater{}, &Candidate::log_bayes_factor));
    }
}

TEST_F(Diagnosed, TheSkeletonDiagnosesItselfAsWell) {
    const auto skeleton = body_.skeleton();
    const Explanation hidden = with(bare_truth(*skeleton, 1), find_effect("gravity"), half_g);
    const MeasurementSet set = make_twin(*skeleton, body_.set(SmallBody::probes()), hidden, sigma);
    const Diagnosis found = identify::diagnose(*skeleton, set, {});
    EXPECT_EQ(found.verdict, Verdict::missing_effect);
    EXPECT_THAT(found.explanation, ElementsAre("gravity"));
    EXPECT_EQ(found.law, 1);
    EXPECT_NEAR(estimate(found.ranking.front(), "gz"), 9810 * half_g.z(), 3 * found.ranking.front().estimate.sd[2]);
    EXPECT_EQ(identify::diagnose(
                  *skeleton, make_twin(*skeleton, body_.set(SmallBody::probes()), bare_truth(*skeleton, 1), sigma), {})
                  .verdict,
              Verdict::adequate);
}

}  // namespace
}  // namespace palpate::identify
