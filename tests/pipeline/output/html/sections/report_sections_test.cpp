// Sections and charts of the report that need no run.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "pipeline/output/html/charts/charts.h"
#include "pipeline/output/html/sections/fit_sections.h"
#include "pipeline/output/html/sections/inquiry_sections.h"

namespace palpate::pipeline {
namespace {

using nlohmann::json;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

TEST(MissingSection, PutsEveryCandidateInWords) {
    const json diagnosis = {{"verdict", "missing-effect"},
                            {"explanation", {"gravity"}},
                            {"noise_mm", 0.1},
                            {"noise_known", true},
                            {"baseline",
                             {{"law", "neo-hooke"},
                              {"young_mpa", 0.1},
                              {"poisson", nullptr},
                              {"rms_mm", 2.0},
                              {"held_out_rms_mm", 2.1},
                              {"whitened_rms", 20.0}}},
                            {"ranking",
                             {{{"effect", "gravity"},
                               {"log_bayes_factor", 412.3},
                               {"probability", 1.0},
                               {"rms_mm", 0.1},
                               {"held_out_rms_mm", 0.11},
                               {"whitened_rms", 1.0},
                               {"predicted_rms_mm", 0.1},
                               {"parameters", {{"gz", {{"value", -9810.0}, {"sd", 12.0}, {"unit", "mm/s^2"}}}}},
                               {"sentence", "Gravity is <missing>."}},
                              {{"effect", "contact"},
                               {"log_bayes_factor", 3.0},
                               {"probability", 0.0},
                               {"rms_mm", nullptr},
                               {"held_out_rms_mm", nullptr},
                               {"whitened_rms", nullptr},
                               {"predicted_rms_mm", 1.7},
                               {"parameters", json::object()},
                               {"objection", "too much of the misfit"}}}}};
    EXPECT_THAT(missing_section(diagnosis),
                AllOf(HasSubstr("<b>Claimed.</b> Gravity is &lt;missing&gt;."), HasSubstr("gz -9810 ± 12 mm/s^2"),
                      HasSubstr("The body meets an unreported flat obstacle"),
                      HasSubstr("Not claimed: too much of the misfit."),
                      HasSubstr("Not refitted: its linear estimate leaves 1.7 mm rms."), HasSubstr("above 0.99"),
                      HasSubstr("below 0.01"), Not(HasSubstr("left out"))));
    EXPECT_EQ(missing_section(nullptr), "");
}

TEST(SpheresSection, DrawsTheCurveWhereThereIsOne) {
    const auto step = [](int spheres, double rms, bool own) {
        return json{
            {"own", own}, {"spheres", spheres}, {"error", {{"rms", rms}, {"median", rms / 2}, {"p90", 2 * rms}}}};
    };
    const json steps{step(8, 0.3, true), step(64, 0.1, false)};
    EXPECT_THAT(spheres_section({{"rungs", steps}}),
                AllOf(HasSubstr("rms at 8: 30"), HasSubstr("90th percentile at 64: 20"), HasSubstr("8 free spheres")));
    EXPECT_EQ(spheres_section(nullptr), "");
}

TEST(LineChart, NeedsTwoPlaces) {
    EXPECT_EQ(line_chart({{"a", {}}}, "t", "x"), "");
    EXPECT_EQ(line_chart({{"a", {{1, 2}}}}, "t", "x"), "");
    EXPECT_THAT(line_chart({{"a", {{1, 2}, {2, 2}}}}, "t", "x"), HasSubstr("polyline"));
}

}  // namespace
}  // namespace palpate::pipeline
