// What results say in words: the verdict first, with the numbers behind it.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pipeline/output/ladder.h"
#include "pipeline/output/text/comparison.h"
#include "pipeline/output/text/diagnosis.h"
#include "pipeline/output/text/words.h"

namespace palpate::pipeline {
namespace {

using nlohmann::json;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

json candidate(const std::string& effect, double log_bayes_factor, double probability, const std::string& sentence) {
    return {{"effect", effect},
            {"kind", "body"},
            {"probability", probability},
            {"log_bayes_factor", log_bayes_factor},
            {"rms_mm", 0.9},
            {"whitened_rms", 0.98},
            {"held_out_rms_mm", 0.92},
            {"sentence", sentence}};
}

json diagnosis(const std::string& verdict, const std::vector<std::string>& explanation) {
    return {{"verdict", verdict},
            {"explanation", explanation},
            {"baseline",
             {{"rms_mm", 6.4},
              {"whitened_rms", 12.0},
              {"load_exponent", {{"words", "the error is there without any load"}}}}},
            {"ranking",
             {candidate("gravity", 412, 0.98, "Gravity is missing: 9.90 m/s^2 along (0, -1, 0)."),
              candidate("misalignment", 412 - 54 * std::log(10.0), 0.0, "The readings are misaligned.")}},
            {"next_probe", nullptr}};
}

TEST(DiagnosisInWords, NamesTheEffectWithItsEvidence) {
    EXPECT_THAT(
        diagnosis_in_words(diagnosis("missing-effect", {"gravity"})),
        AllOf(HasSubstr("Gravity is missing (probability 0.98): 9.90 m/s^2"), HasSubstr("errs by 6.4 mm"),
              HasSubstr("there without any load"), HasSubstr("from 6.4 to 0.9 mm rms (0.92 on probes left out)"),
              HasSubstr("Runner-up: misalignment, 10^-54 times as likely")));
}

TEST(DiagnosisInWords, NamesSeveralTogether) {
    EXPECT_THAT(diagnosis_in_words(diagnosis("missing-effect", {"gravity", "misalignment"})),
                AllOf(HasSubstr("gravity and misalignment"), HasSubstr("Gravity is missing: 9.90"),
                      HasSubstr("The readings are misaligned. Without it")));
}

TEST(DiagnosisInWords, AmbiguousNamesBothAndTheProbeBetweenThem) {
    json d = diagnosis("ambiguous", {"gravity"});
    d["next_probe"] = {{"kind", "load"},
                       {"why", "separates gravity from misalignment: press here"},
                       {"contact", {40, 0, 20}},
                       {"force", {0, 0, -0.3}}};
    EXPECT_THAT(diagnosis_in_words(d), AllOf(HasSubstr("cannot decide which: gravity or misalignment"),
                                             HasSubstr("The next probe separates gravity from misalignment"),
                                             HasSubstr("(0, 0, -0.3) N at (40, 0, 20) mm")));
}

TEST(DiagnosisInWords, UnexplainedClaimsNothing) {
    EXPECT_THAT(diagnosis_in_words(diagnosis("unexplained", {})),
                AllOf(HasSubstr("outside the catalogue"), HasSubstr("12 times what noise"),
                      HasSubstr("The nearest is gravity"), Not(HasSubstr("Gravity is missing"))));
}

TEST(DiagnosisInWords, AdequateSaysWhatIsLeft) {
    json d = diagnosis("adequate", {});
    d["ranking"][0]["log_bayes_factor"] = -1.2;
    EXPECT_THAT(diagnosis_in_words(d),
                AllOf(HasSubstr("The model is adequate"), HasSubstr("gravity"), HasSubstr("-1.2")));
}

TEST(DiagnosisInWords, NeedsNoRanking) {
    for (const char* verdict : {"missing-effect", "ambiguous", "unexplained", "adequate"}) {
        json d = diagnosis(verdict, {});
        d["ranking"] = json::array();
        EXPECT_FALSE(diagnosis_in_words(d).empty()) << verdict;
    }
}

json compared() {
    return {{"error", {{"rms_mm", 1.8}, {"max_mm", 6.0}, {"relative", 0.44}, {"noise_mm", 0.05}}},
            {"adequate", false},
            {"reference", {{"rms_mm", 1.7}, {"whitened_rms", 23.0}}},
            {"baseline", {{"law", "neo-hooke"}, {"young_mpa", 0.31}, {"poisson", 0.45}, {"poisson_sd", 0.01}}},
            {"budget", {{"noise", 0.01}, {"reduction", 0.12}, {"missing_physics", 0.87}}},
            {"regions",
             {{{"at", {1, 2, 3}}, {"strange", true}, {"whitened_rms", 4.0}},
              {{"at", {80, 20, 0}}, {"strange", true}, {"whitened_rms", 9.0}},
              {{"at", {9, 9, 9}}, {"strange", false}, {"whitened_rms", 1.0}}}}};
}

TEST(CompareInWords, TellsTheBudgetAndTheWorstRegionFirst) {
    EXPECT_THAT(compare_in_words(compared()),
                AllOf(HasSubstr("the model lacks something"), HasSubstr("neo-hooke, E = 0.31 MPa, nu = 0.450 +- 0.010"),
                      HasSubstr("1.0 % is noise, 12.0 % the coarseness of the skeleton, 87.0 % physics"),
                      HasSubstr("2 of 3 regions, worst round (80, 20, 0) (9 sigma), (1, 2, 3)")));
}

TEST(CompareInWords, BlamesTheSkeletonWhereFiniteElementsFollow) {
    json c = compared();
    c["budget"] = {{"noise", 0.01}, {"reduction", 0.9}, {"missing_physics", 0.09}};
    EXPECT_THAT(compare_in_words(c), HasSubstr("mostly the coarseness of the skeleton"));
}

TEST(CompareInWords, BlamesNothingWhereFiniteElementsLeaveNoise) {
    json c = compared();
    c["reference"]["whitened_rms"] = 1.05;
    EXPECT_THAT(compare_in_words(c),
                AllOf(Not(HasSubstr("lacks")), HasSubstr("87.0 % uncertainty of contacts and clamps")));
}

TEST(CompareInWords, AnErrorBeyondTheDisplacementIsToldAsTimesOfIt) {
    json c = compared();
    c["error"]["relative"] = 2900.4;
    EXPECT_THAT(compare_in_words(c), AllOf(HasSubstr("2900 times the displacement"), HasSubstr("explains nothing"),
                                           HasSubstr("held, the units, the sign of the forces"), Not(HasSubstr("e+"))));
    EXPECT_THAT(compare_in_words(compared()), AllOf(HasSubstr("44.0 % of"), Not(HasSubstr("explains nothing"))));
    json d = diagnosis("unexplained", {});
    EXPECT_THAT(diagnosis_in_words(d), Not(HasSubstr("explains nothing")));
    d["baseline"]["relative"] = 1.4;
    EXPECT_THAT(diagnosis_in_words(d), HasSubstr("explains nothing"));
}

TEST(CompareInWords, NeedsNoReference) {
    json c = compared();
    for (const char* key : {"reference", "baseline", "budget"}) c[key] = nullptr;
    EXPECT_THAT(compare_in_words(c),
                AllOf(HasSubstr("1.8 mm rms"), Not(HasSubstr("finite elements")), HasSubstr("cannot tell apart")));
}

TEST(LadderInWords, TellsEveryStepAndTheVerdict) {
    const json ladder = {
        {"steps",
         {{{"effects", json::array()}, {"rms_mm", 6.4}, {"held_out_rms_mm", 6.3}, {"reference", nullptr}},
          {{"effects", {"gravity"}},
           {"rms_mm", 0.9},
           {"held_out_rms_mm", nullptr},
           {"predicted_rms_mm", 1.0},
           {"reference", {{"rms_mm", 0.8}, {"held_out_rms_mm", 0.85}}}}}},
        {"verdict", "adequate"}};
    EXPECT_THAT(ladder_in_words(ladder),
                AllOf(HasSubstr("Without: 6.4 mm rms (6.3 on probes held out)."),
                      HasSubstr("With gravity: 0.9 mm rms; in finite elements 0.8 mm rms (0.85 on probes held out), "
                                "where the screen had expected 1."),
                      HasSubstr("The residual of the finite-element model is noise.")));
}

TEST(Words, AnAsideStandsBeforeTheColonOrTheFullStop) {
    EXPECT_EQ(with_aside("Gravity is missing: 9.8.", "p"), "Gravity is missing (p): 9.8.");
    EXPECT_EQ(with_aside("It gives way.", "p"), "It gives way (p).");
    EXPECT_EQ(with_aside("It gives way", "p"), "It gives way (p)");
}

TEST(Words, ListsReadAsInASentence) {
    EXPECT_EQ(listed({}), "");
    EXPECT_EQ(listed({"a"}), "a");
    EXPECT_EQ(listed({"a", "b", "c"}), "a, b and c");
}

}  // namespace
}  // namespace palpate::pipeline
