#include "pipeline/output/text/diagnosis.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

namespace palpate::pipeline {
namespace {

using nlohmann::json;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

json candidate(const std::string& effect, double log_bayes_factor, double probability, const std::string& sentence) {
    return {{"effect", effect},
            {"kind", "body"},
            {"parameters", json::object()},
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
              {"held_out_rms_mm", 6.6},
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
        AllOf(HasSubstr("Gravity is missing (probability 0.98): 9.90 m/s^2"),
              HasSubstr("rms error of the model is 6.4 mm over all states; the error is present even without load."),
              HasSubstr("lowers the error to 0.9 mm, no more than noise"),
              HasSubstr("Probes left out of the fit one at a time are predicted to within 0.92 mm rms, without it to "
                        "within 6.6 "
                        "mm."),
              HasSubstr("Runner-up: misalignment, less than a thousandth as likely."), Not(HasSubstr("10^"))));
}

/// A fault of the measurement may differ from probe to probe.
TEST(DiagnosisInWords, SaysWhyAFaultForecastsNoBetterInMillimetres) {
    json d = diagnosis("missing-effect", {"gravity"});
    d["ranking"][0].update({{"kind", "measurement"}, {"held_out_rms_mm", 7.0}, {"held_out_whitened_rms", 0.97}});
    d["baseline"]["held_out_whitened_rms"] = 1.55;
    EXPECT_THAT(diagnosis_in_words(d),
                HasSubstr("without it to within 6.6 mm, as the fault is not known in a probe left "
                          "out; normalised by its spread and the noise, the error falls from "
                          "1.55 to 0.97."));
    d["ranking"][0]["held_out_whitened_rms"] = 1.6;
    EXPECT_THAT(diagnosis_in_words(d), HasSubstr("6.6 mm: from so few probes the prediction does not improve."));
}

/// Single readings that were set aside are left out of the baseline, too.
TEST(DiagnosisInWords, SaysWhatIsLeftWithoutSingleReadings) {
    json d = diagnosis("missing-effect", {"gravity"});
    d["ranking"][0].update({{"kind", "measurement"}, {"rms_mm", nullptr}});
    d["baseline"]["whitened_rms"] = 0.98;
    EXPECT_THAT(diagnosis_in_words(d),
                AllOf(HasSubstr("Without these readings the rms error of the model is 6.4 mm, no more than "
                                "noise"),
                      Not(HasSubstr("without any load")), Not(HasSubstr("even without load"))));
}

TEST(DiagnosisInWords, TellsTheStiffnessWithTheEffectAndWithout) {
    json d = diagnosis("missing-effect", {"gravity"});
    d["baseline"].update({{"young_mpa", 0.168}, {"poisson", nullptr}});
    d["explained"] = {{"young_mpa", 0.2417}, {"young_sd_mpa", 0.012}, {"poisson", 0.452}, {"poisson_sd", 0.031}};
    EXPECT_THAT(diagnosis_in_words(d), AllOf(HasSubstr("rms error of the finite-element model is 6.4 mm"),
                                             HasSubstr("The fit gives E = 0.242 ± 0.012 MPa, ν = 0.45 ± 0.03; without "
                                                       "it, E = 0.168 MPa.")));
}

TEST(DiagnosisInWords, SaysWhyACloserFitIsNotTheAnswer) {
    json d = diagnosis("missing-effect", {"gravity"});
    d["ranking"][0]["parameters"] = {{"gx", 0}, {"gy", 0}, {"gz", 0}};
    d["ranking"][1]["parameters"] = {{"tx", 0}, {"ty", 0}, {"tz", 0}, {"rx", 0}, {"ry", 0}, {"rz", 0}};
    EXPECT_THAT(diagnosis_in_words(d), Not(HasSubstr("parameters instead"))) << "it fits no closer";
    d["ranking"][1]["rms_mm"] = 0.85;
    EXPECT_THAT(diagnosis_in_words(d), HasSubstr("It leaves 0.85 mm rms, but with 6 parameters instead of 3"));
}

TEST(DiagnosisInWords, NamesSeveralTogether) {
    EXPECT_THAT(diagnosis_in_words(diagnosis("missing-effect", {"gravity", "misalignment"})),
                AllOf(HasSubstr("gravity and misalignment"), HasSubstr("Gravity is missing: 9.90"),
                      HasSubstr("The readings are misaligned. Without them")));
}

TEST(DiagnosisInWords, SaysWhatSeveralTogetherLeave) {
    json d = diagnosis("missing-effect", {"gravity", "misalignment"});
    d["baseline"].update({{"young_mpa", 0.168}, {"poisson", nullptr}});
    d["explained"] = {{"young_mpa", 0.2417}, {"young_sd_mpa", 0.012}, {"poisson", 0.452},       {"poisson_sd", 0.031},
                      {"rms_mm", 0.85},      {"whitened_rms", 0.97},  {"held_out_rms_mm", 0.88}};
    EXPECT_THAT(diagnosis_in_words(d),
                AllOf(HasSubstr("Taking them into account lowers the error to 0.85 mm, no more than noise"),
                      HasSubstr("predicted to within 0.88 mm rms, without them to within 6.6 mm."),
                      HasSubstr("E = 0.242 ± 0.012 MPa"), Not(HasSubstr("Runner-up"))));
    d["explained"]["rms_mm"] = 6.5;
    EXPECT_THAT(diagnosis_in_words(d), HasSubstr("Taking them into account leaves an error of 6.5 mm"));
}

TEST(DiagnosisInWords, TwoOfAKindHaveTheirOwnSentences) {
    json d = diagnosis("missing-effect", {"inclusion", "inclusion"});
    d["ranking"] = {candidate("inclusion", 412, 1, "The first lump."),
                    candidate("inclusion", 412, 1, "The second lump.")};
    EXPECT_THAT(diagnosis_in_words(d),
                HasSubstr("Missing together: inclusion (2). The first lump. The second lump. Without them"));
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

TEST(DiagnosisInWords, AnErrorBeyondTheDisplacementExplainsNothing) {
    json d = diagnosis("unexplained", {});
    EXPECT_THAT(diagnosis_in_words(d), Not(HasSubstr("explains nothing")));
    d["baseline"]["relative"] = 1.4;
    EXPECT_THAT(diagnosis_in_words(d), HasSubstr("explains nothing"));
    json named = diagnosis("missing-effect", {"gravity"});
    named["baseline"]["relative"] = 1.4;
    EXPECT_THAT(diagnosis_in_words(named), Not(HasSubstr("explains nothing")));
}

}  // namespace
}  // namespace palpate::pipeline
