#include "identify/preflight/prospects/evidence_of_signatures.h"

#include <gtest/gtest.h>

#include <cmath>

#include "identify/effects/catalogue.h"

namespace palpate::identify {
namespace {

EffectSignature signature(const std::string& name, const Eigen::MatrixXd& columns, bool one_sided = false) {
    return {find_effect(name), {columns, Eigen::VectorXd::Ones(1), one_sided}};
}

// A rule that asks for the same evidence whether or not what is left passes for noise.
constexpr NamingRules rules{.least_evidence = 12, .least_next_to_noise = 12, .most_left = 1.1, .least_lead = 5};

TEST(EvidenceOfSignatures, OfOneColumnIsThatOfTheScoreTest) {
    // |b| = 3 in noise of 1: M = 9, and ln BF(a) = a^2 81 / 10 / 2 - ln(10) / 2.
    const Whitening V = noise_alone(9);
    const std::vector<EffectSignature> signatures{signature("pressure", Eigen::VectorXd::Ones(9))};
    const EffectCases cases = draw_cases(signatures[0]);
    ASSERT_EQ(cases.alternative.size(), 2u);  // either sign
    const auto least = EvidenceOfSignatures(V, signatures).least_factors(0, cases, rules);
    const double expected = std::sqrt((12 + 0.5 * std::log(10)) * 2 * 10 / 81);
    for (const double factor : least.named) EXPECT_NEAR(factor, expected, 0.01 * expected);  // as it is bisected
    EXPECT_EQ(least.rival, std::vector<int>({-1, -1}));
}

TEST(EvidenceOfSignatures, OfOneSideIsMoreByLnTwo) {
    const Whitening V = noise_alone(9);
    const std::vector<EffectSignature> signatures{signature("viscosity", Eigen::VectorXd::Ones(9), true)};
    const EffectCases cases = draw_cases(signatures[0]);
    ASSERT_EQ(cases.alternative.size(), 1u);
    const auto least = EvidenceOfSignatures(V, signatures).least_factors(0, cases, rules);
    const double expected = std::sqrt((12 - std::log(2) + 0.5 * std::log(10)) * 2 * 10 / 81);
    EXPECT_NEAR(least.named[0], expected, 0.01 * expected);
}

TEST(EvidenceOfSignatures, OfEffectsThatLookAlikeIsNeverEnoughForAName) {
    const Whitening V = noise_alone(9);
    const Eigen::VectorXd b = Eigen::VectorXd::LinSpaced(9, -1, 2);
    const std::vector<EffectSignature> signatures{signature("pressure", b), signature("force-gain", b)};
    const auto least = EvidenceOfSignatures(V, signatures).least_factors(0, draw_cases(signatures[0]), rules);
    EXPECT_TRUE(std::isinf(least.named[0]));
    EXPECT_LT(least.seen[0], 10);
    EXPECT_EQ(least.rival[0], 1);
}

TEST(EvidenceOfSignatures, OfWhatANuisanceAbsorbsNeedsMore) {
    const Eigen::VectorXd b = Eigen::VectorXd::Ones(9);
    const std::vector<EffectSignature> signatures{signature("pressure", b)};
    const EffectCases cases = draw_cases(signatures[0]);
    // A nuisance that moves half of the rows alike, by ten sigmas or so.
    Eigen::MatrixXd A = Eigen::MatrixXd::Zero(9, 1);
    A.topRows(5).setOnes();
    const Whitening unsure(Eigen::VectorXd::Ones(9), A, Eigen::VectorXd::Constant(1, 0.01));
    const auto sure = EvidenceOfSignatures(noise_alone(9), signatures).least_factors(0, cases, rules);
    const auto less_sure = EvidenceOfSignatures(unsure, signatures).least_factors(0, cases, rules);
    EXPECT_GT(less_sure.named[0], 1.3 * sure.named[0]);  // 4 of 9 rows are left: 1.5 times, less the prior's share
}

TEST(EvidenceOfSignatures, CasesAreOfTheSizeThatThePriorExpects) {
    EffectSignature gravity{find_effect("gravity"), {}};
    gravity.columns = {Eigen::MatrixXd::Identity(6, 3), Eigen::Vector3d(2, 2, 2), false};
    const EffectCases cases = draw_cases(gravity);
    ASSERT_GT(cases.alternative.size(), 10u);
    for (Eigen::Index c = 0; c < cases.values.cols(); ++c)
        EXPECT_NEAR(cases.values.col(c).norm(), 2 * std::sqrt(3), 1e-9);  // rms of three numbers of sd 2
}

TEST(EvidenceOfSignatures, CasesThatAlterNothingAreLeftOut) {
    Eigen::MatrixXd columns = Eigen::MatrixXd::Zero(6, 4);
    columns.col(2).setOnes();
    const EffectCases cases = draw_cases(signature("contact", columns, true));
    ASSERT_FALSE(cases.alternative.empty());
    for (const Eigen::Index i : cases.alternative) EXPECT_EQ(i, 2);
}

}  // namespace
}  // namespace palpate::identify
