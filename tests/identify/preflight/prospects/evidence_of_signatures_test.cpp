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

/// The least factor a by which b is named where M = b^T V^-1 b: ln BF(a) = a^2 M^2 / (1 + M) / 2 - ln(1 + M) / 2, and
/// more by `besides`. Bisected to 1 %.
double least_factor(double M, double besides = 0) {
    return std::sqrt((rules.least_evidence - besides + 0.5 * std::log(1 + M)) * 2 * (1 + M)) / M;
}
constexpr double bisected = 0.01;

TEST(EvidenceOfSignatures, OfOneColumnIsThatOfTheScoreTest) {
    const Whitening V = noise_alone(9);
    const std::vector<EffectSignature> signatures{signature("pressure", Eigen::VectorXd::Ones(9))};
    const EffectCases cases = draw_cases(signatures[0]);
    ASSERT_EQ(cases.alternative.size(), 2u);  // either sign
    const auto least = EvidenceOfSignatures(V, signatures).least_factors(0, cases, rules);
    const double expected = least_factor(9);
    for (const double factor : least.named) EXPECT_NEAR(factor, expected, bisected * expected);
    EXPECT_EQ(least.rival, std::vector<int>({-1, -1}));
}

TEST(EvidenceOfSignatures, OfOneSideIsMoreByLnTwo) {
    const Whitening V = noise_alone(9);
    const std::vector<EffectSignature> signatures{signature("viscosity", Eigen::VectorXd::Ones(9), true)};
    const EffectCases cases = draw_cases(signatures[0]);
    ASSERT_EQ(cases.alternative.size(), 1u);
    const auto least = EvidenceOfSignatures(V, signatures).least_factors(0, cases, rules);
    const double expected = least_factor(9, std::log(2));
    EXPECT_NEAR(least.named[0], expected, bisected * expected);
}

TEST(EvidenceOfSignatures, OfEffectsThatLookAlikeIsNeverEnoughForAName) {
    const Whitening V = noise_alone(9);
    const Eigen::VectorXd b = Eigen::VectorXd::LinSpaced(9, -1, 2);
    const std::vector<EffectSignature> signatures{signature("pressure", b), signature("force-gain", b)};
    const auto least = EvidenceOfSignatures(V, signatures).least_factors(0, draw_cases(signatures[0]), rules);
    EXPECT_TRUE(std::isinf(least.named[0]));
    const double expected = least_factor(b.squaredNorm());
    EXPECT_NEAR(least.seen[0], expected, bisected * expected);
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
    EXPECT_NEAR(sure.named[0], least_factor(9), bisected * least_factor(9));
    const double expected = least_factor(4 + 5 / (1 + 5 / 0.01));  // four rows are left, and what they leave of five
    EXPECT_NEAR(less_sure.named[0], expected, bisected * expected);
}

TEST(EvidenceOfSignatures, CasesAreOfTheSizeThatThePriorExpects) {
    EffectSignature gravity{find_effect("gravity"), {}};
    gravity.columns = {Eigen::MatrixXd::Identity(6, 3), Eigen::Vector3d(2, 2, 2), false};
    const EffectCases cases = draw_cases(gravity);
    ASSERT_EQ(cases.alternative.size(), 40u);  // as many as are drawn where numbers have a direction
    for (Eigen::Index c = 0; c < cases.values.cols(); ++c)
        EXPECT_NEAR(cases.values.col(c).norm(), 2 * std::sqrt(3), 1e-14);  // rms of three numbers of sd 2
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
