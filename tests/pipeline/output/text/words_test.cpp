// What results say in words: the verdict first, with the numbers behind it.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pipeline/output/results/ladder.h"
#include "pipeline/output/text/comparison/comparison.h"
#include "pipeline/output/text/comparison/worst.h"
#include "pipeline/output/text/errors.h"
#include "pipeline/output/text/words.h"

namespace palpate::pipeline {
namespace {

using nlohmann::json;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

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
    EXPECT_THAT(
        compare_in_words(compared()),
        AllOf(HasSubstr("the model lacks something"), HasSubstr("neo-Hookean law, E = 0.31 MPa, ν = 0.450 ± 0.010"),
              HasSubstr("1.0 % is noise, 12.0 % the coarseness of the skeleton, 87.0 % unexplained"),
              HasSubstr("2 of 3 regions, worst around (80, 20, 0) (9 sigma), (1, 2, 3)")));
}

TEST(CompareInWords, BlamesTheSkeletonWhereFiniteElementsFollow) {
    json c = compared();
    c["budget"] = {{"noise", 0.01}, {"reduction", 0.9}, {"missing_physics", 0.09}};
    EXPECT_THAT(compare_in_words(c), HasSubstr("mostly the coarseness of the skeleton"));
}

TEST(CompareInWords, BlamesNothingWhereFiniteElementsLeaveNoise) {
    json c = compared();
    c["reference"]["whitened_rms"] = 1.05;
    EXPECT_THAT(compare_in_words(c), AllOf(Not(HasSubstr("lacks")), HasSubstr("87.0 % unexplained")));
}

/// What finite elements explain is no physics that is missing, however it goes with the load.
TEST(CompareInWords, TellsHowTheErrorGoesWithTheLoadOnlyWhereItIsUnexplained) {
    json c = compared();
    c["load_exponent"] = {{"value", -0.62}, {"sd", 0.31}, {"words", "the error is there without any load"}};
    EXPECT_THAT(compare_in_words(c), HasSubstr("to the power -0.6 ± 0.3: the error is there without any load."));
    c["reference"]["whitened_rms"] = 0.9;
    EXPECT_THAT(compare_in_words(c, "The model with gravity"),
                AllOf(Not(HasSubstr("without any load")), HasSubstr("The model with gravity is off by 1.8 mm rms"),
                      HasSubstr("1.7 mm rms: no more than noise and unknown contacts explain.")));
}

TEST(CompareInWords, AnErrorBeyondTheDisplacementIsToldAsTimesOfIt) {
    json c = compared();
    c["error"]["relative"] = 2900.4;
    EXPECT_THAT(compare_in_words(c), AllOf(HasSubstr("2900 times the displacement"), HasSubstr("explains nothing"),
                                           HasSubstr("held, the units, the sign of the forces"), Not(HasSubstr("e+"))));
    EXPECT_THAT(compare_in_words(compared()), AllOf(HasSubstr("44.0 % of"), Not(HasSubstr("explains nothing"))));
}

TEST(CompareInWords, NeedsNoReference) {
    json c = compared();
    for (const char* key : {"reference", "baseline", "budget"}) c[key] = nullptr;
    EXPECT_THAT(compare_in_words(c),
                AllOf(HasSubstr("1.8 mm rms"), Not(HasSubstr("finite elements")), HasSubstr("cannot distinguish")));
}

TEST(LadderInWords, TellsEveryStepAndTheVerdict) {
    const json ladder = {
        {"steps",
         {{{"effects", json::array()}, {"rms_mm", 6.4}, {"held_out_rms_mm", 6.3}, {"reference", nullptr}},
          {{"effects", {"gravity"}},
           {"rms_mm", 0.9},
           {"held_out_rms_mm", nullptr},
           {"predicted_rms_mm", 1.0},
           {"reference",
            {{"rms_mm", 0.8},
             {"held_out_rms_mm", 0.85},
             {"young_mpa", 0.242},
             {"young_sd_mpa", 0.012},
             {"poisson", 0.499},
             {"poisson_sd", 2e-5},
             {"poisson_declared", true}}}}}},
        {"verdict", "adequate"}};
    EXPECT_THAT(ladder_in_words(ladder),
                AllOf(HasSubstr("Nothing added: 6.4 mm rms (6.3 mm on held-out probes)."),
                      HasSubstr("With gravity: real-time model 0.9 mm rms; finite-element model 0.8 mm rms (0.85 mm on "
                                "held-out probes), E = 0.242 ± 0.012 MPa, ν = 0.499 (declared)."),
                      HasSubstr("The residual of the finite-element model is noise.")));
    json worse = ladder;
    worse["verdict"] = "missing-effect";
    worse["not_added"] = {{{"effect", "friction"}, {"why", "with it the skeleton is off by 2 mm"}}};
    EXPECT_THAT(ladder_in_words(worse),
                AllOf(HasSubstr("friction is not added: with it the skeleton is off by 2 mm.\n"),
                      HasSubstr("The model still lacks friction; a skeleton of more spheres")));
}

TEST(ErrorInWords, IsOfWhatWasRead) {
    json error = {{"rms_mm", 0.12}, {"held_out_rms_mm", nullptr}};
    EXPECT_EQ(rms_in_words(error), "0.12 mm");
    EXPECT_EQ(held_out_rms_in_words(error), "");
    error["held_out_rms_mm"] = 0.13;
    error["reactions_rms_n"] = 0.004;
    error["held_out_reactions_rms_n"] = 0.005;
    EXPECT_EQ(rms_in_words(error), "0.12 mm and 0.004 N");
    EXPECT_EQ(held_out_rms_in_words(error), "0.13 mm and 0.005 N");
    EXPECT_STREQ(keys_of(error).unit, "mm");
    error["rms_mm"] = error["held_out_rms_mm"] = 0.0;  // as of no positions
    EXPECT_EQ(rms_in_words(error), "0.004 N");
    EXPECT_EQ(held_out_rms_in_words(error), "0.005 N");
    EXPECT_STREQ(keys_of(error).unit, "N");
}

TEST(LadderInWords, TellsNoiseFromWhatContactsExplain) {
    json on_links = {
        {"steps",
         {{{"effects", json::array()}, {"rms_mm", 0.16}, {"held_out_rms_mm", nullptr}, {"reference", nullptr}}}},
        {"verdict", "adequate"},
        {"noise_mm", 0.15}};
    EXPECT_THAT(ladder_in_words(on_links), HasSubstr("What is left is noise."));
    on_links["noise_mm"] = 0.06;
    EXPECT_THAT(ladder_in_words(on_links),
                AllOf(HasSubstr("off by more than the noise of 0.06 mm"), Not(HasSubstr("What is left is noise"))));
}

TEST(Words, APlaceHasNoRoundOff) {
    EXPECT_EQ(pipeline::place({85.0, -7.0, 2.06e-14}), "(85, -7, 0)");
    EXPECT_EQ(pipeline::place({-1e-12, 0.0, 1e-3}), "(0, 0, 0.001)");
}

TEST(Words, ACertaintyIsToldAsABound) {
    EXPECT_EQ(probability_in_words(0.0), "below 0.01");
    EXPECT_EQ(probability_in_words(0.5), "0.50");
    EXPECT_EQ(probability_in_words(0.99999), "above 0.99");
    EXPECT_EQ(in_sigmas(0.876), "no more than noise and unknown contacts explain");
    EXPECT_EQ(in_sigmas(4.84), "4.8 times what noise and unknown contacts explain");
    EXPECT_EQ(in_sigmas(nullptr), "an unknown multiple of the noise");
    EXPECT_THAT(material_in_words({{"young_mpa", 1.0}, {"poisson", -0.5}, {"poisson_sd", 0.4}}),
                HasSubstr("ν hardly known (-0.5 ± 0.4)"));
    EXPECT_EQ(material_in_words({{"young_mpa", 1.0}, {"poisson", 0.4993}, {"poisson_sd", 0.001}}),
              "E = 1 MPa, ν above 0.497");
    EXPECT_EQ(material_in_words({{"young_mpa", 0.0148}, {"young_sd_mpa", 0.44}, {"poisson", nullptr}}),
              "E = 0.015 MPa, hardly known (± 0.4)");
    const json regions = {{{"name", "bone"}, {"young_mpa", 20.0}, {"sd", nullptr}},
                          {{"name", "lump"}, {"young_mpa", 1.5}, {"sd", 4.0}}};
    EXPECT_EQ(material_in_words({{"young_mpa", 1.0}, {"poisson", nullptr}, {"regions", regions}}),
              "E = 1 MPa; bone: E = 20 MPa (declared); lump: E = 1.5 MPa, hardly known (± 4)");
}

TEST(WorstTable, NamesProbesMarkersAndThePartOfTheBody) {
    const json compare = {
        {"box", {{"min", {0, 0, 0}}, {"max", {80, 20, 20}}}},
        {"probes",
         {{{"probe", 1}, {"time", 0.0}, {"rms_mm", 0.5}, {"max_mm", 1.0}, {"relative", nullptr}, {"at", nullptr}},
          {{"probe", 3}, {"time", 2.0}, {"rms_mm", 2.1}, {"max_mm", 5.0}, {"relative", 0.5}, {"at", {80, 10, 20}}},
          {{"probe", 5},
           {"time", 1.0},
           {"rms_mm", 0.7},
           {"max_mm", 1.0},
           {"relative", 0.1},
           {"at", nullptr},
           {"driven_by", "t1 at 3.08 N"}}}},
        {"markers",
         {{{"marker", 4}, {"rms_mm", 0.1}, {"at", {40, 10, 10}}},
          {{"marker", 1}, {"name", "tip_top"}, {"rms_mm", 3.0}, {"at", {79, 0, 20}}}}}};
    const std::string table = worst_table(compare);
    EXPECT_THAT(table, AllOf(HasSubstr("probe 3, 2 s"), HasSubstr("50.0 %"), HasSubstr("(80, 10, 20) mm, +x end, top"),
                             HasSubstr("no load"), HasSubstr("t1 at 3.08 N"), HasSubstr("marker tip_top"),
                             HasSubstr("+x end, -y side, top"), HasSubstr("marker 4"), HasSubstr("middle")));
    EXPECT_LT(table.find("probe 3"), table.find("probe 1")) << "the worst first";
    EXPECT_LT(table.find("tip_top"), table.find("marker 4"));
}

TEST(WorstTable, NamesTheForcesThatAreFarthestOff) {
    const auto force = [](int probe, json measured, double error, json at) {
        return json{
            {"probe", probe},          {"time", 1.0},      {"tool", "indenter"}, {"measured_n", std::move(measured)},
            {"modelled_n", {0, 0, 0}}, {"error_n", error}, {"at", std::move(at)}};
    };
    const json compare = {
        {"box", {{"min", {0, 0, 0}}, {"max", {80, 20, 20}}}},
        {"probes", json::array()},
        {"markers", json::array()},
        {"tool_forces",
         {force(2, {nullptr, nullptr, -0.4}, 0.1, {40, 10, 20}), force(7, {0.0, 0.3, -0.4}, 0.25, {80, 10, 20})}}};
    const std::string table = worst_table(compare);
    EXPECT_THAT(table, AllOf(HasSubstr("Largest force errors"), HasSubstr("25.0 %"), HasSubstr("50.0 %"),
                             HasSubstr("indenter, (80, 10, 20) mm, +x end, top")));
    EXPECT_LT(table.find("probe 7"), table.find("probe 2")) << "the worst first";
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
    EXPECT_EQ(listed({"a", "b", "a"}), "a (2) and b");
}

}  // namespace
}  // namespace palpate::pipeline
