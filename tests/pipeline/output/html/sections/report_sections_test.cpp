// Sections and charts of the report that need no run.

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <regex>
#include <sstream>

#include "mesh/core/surface.h"
#include "pipeline/output/html/charts/charts.h"
#include "pipeline/output/html/charts/picture.h"
#include "pipeline/output/html/charts/svg.h"
#include "pipeline/output/html/sections/diagnosis_sections.h"
#include "pipeline/output/html/sections/fit_sections.h"
#include "tests/temporary_folder.h"

namespace palpate::pipeline {
namespace {

using nlohmann::json;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

TEST(LadderSection, TellsWhyHeldOutProbesErrLess) {
    const json ladder = {
        {"steps", {{{"effects", json::array()}, {"rms_mm", 0.4}, {"held_out_rms_mm", 0.2}, {"reference", nullptr}}}},
        {"held_out_probes", {2}},
        {"noise_mm", 0.1},
        {"verdict", "adequate"}};
    const auto moved_by = [](double fitted, double held_out) {
        json states = json::array();
        for (int probe : {1, 2, 3}) {
            const double moved = probe == 2 ? held_out : fitted;
            states.push_back({{"probe", probe}, {"rms_mm", 0.3}, {"relative", 0.3 / moved}});
        }
        states.push_back({{"probe", 2}, {"rms_mm", 0.3}, {"relative", nullptr}});  // at rest
        return json{{"probes", states}};
    };
    EXPECT_THAT(ladder_section(ladder, moved_by(4, 2)),
                HasSubstr("move the markers by 2 mm rms, the fitted ones by 4 mm"));
    EXPECT_THAT(ladder_section(ladder, moved_by(2, 4)), Not(HasSubstr("move the markers")));
    json more = ladder;
    more["steps"][0]["held_out_rms_mm"] = 0.5;
    EXPECT_THAT(ladder_section(more, moved_by(4, 2)), Not(HasSubstr("move the markers")));
}

TEST(MissingSection, PutsEveryCandidateInWords) {
    json diagnosis = {{"verdict", "missing-effect"},
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
                         {"parameters", json::object()}},
                        {{"effect", "prestress"},
                         {"log_bayes_factor", 12.0},
                         {"probability", 0.0},
                         {"rms_mm", 0.4},
                         {"held_out_rms_mm", 0.5},
                         {"whitened_rms", 3.0},
                         {"predicted_rms_mm", 0.3},
                         {"parameters", json::object()},
                         {"sentence", "The body is prestressed."},
                         {"objection", "too much of the misfit"}}}}};
    EXPECT_THAT(
        missing_section(diagnosis),
        AllOf(HasSubstr("<b>Claimed.</b> Gravity is &lt;missing&gt;."), HasSubstr("gz -9810 ±\u00a012\u00a0mm/s²"),
              HasSubstr("<b>Rejected:</b> too much of the misfit. It would mean: The body is prestressed."),
              HasSubstr("Screened out: its linear estimate leaves 1.7\u00a0mm rms."), HasSubstr("above 0.99"),
              HasSubstr("below 0.01"), Not(HasSubstr("left out"))));
    diagnosis["ranking"][1]["predicted_rms_mm"] = 2 * diagnosis["baseline"]["rms_mm"].get<double>();
    EXPECT_THAT(missing_section(diagnosis), HasSubstr("its linear estimate does not lower the rms error."));
    json& of_map = diagnosis["ranking"][2]["parameters"];
    for (int i = 1; i <= 40; ++i) of_map[fmt::format("a{}", i)] = {{"value", 0.1}, {"sd", 0.3}, {"unit", "1"}};
    EXPECT_THAT(missing_section(diagnosis), AllOf(HasSubstr("40 parameters, listed in"), Not(HasSubstr("a40"))));
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

/// Numbers that stand for `name` in a picture's elements that begin with `element`.
std::vector<double> numbers_in(const std::string& svg, const std::string& element, const std::string& name) {
    std::vector<double> numbers;
    const std::regex one("<" + element + "[^>]* " + name + "=\"(-?[0-9.]+)");
    for (std::sregex_iterator i(svg.begin(), svg.end(), one), end; i != end; ++i) numbers.push_back(std::stod((*i)[1]));
    return numbers;
}

/// A key says what curves are; it is no reading, and none lies over it.
TEST(LineChart, KeepsItsKeysOffTheCurves) {
    const ChartLine dots{"one", {{0, 0}, {1, 3.8}}, ChartLine::Drawn::dots};
    const std::string chart = line_chart(
        {dots, {"with inclusion, anisotropy, misalignment and outliers", {{0, 1}}}, {"noise", {{0, 1}}}}, "t", "x");
    EXPECT_THAT(chart, AllOf(HasSubstr("one at 1: 3.8"), HasSubstr(">4</text>")));
    const std::vector<double> heights = numbers_in(chart, "circle", "cy");
    ASSERT_EQ(heights.size(), 5U) << "a key of dots, and four readings";
    std::size_t told = 0;
    for (std::size_t at = chart.find("<title>"); at != std::string::npos; at = chart.find("<title>", at + 1)) ++told;
    EXPECT_EQ(told, 4U);
    constexpr double row = 16, radius = 3;  // [px]
    const double key = heights[0], highest = *std::ranges::min_element(heights.begin() + 1, heights.end());
    EXPECT_GT(highest - radius, key + row) << "the second row of keys lies between";
}

TEST(BarChart, NamesItsBarsWhereThereIsRoom) {
    std::vector<Bar> bars;
    for (int probe = 0; probe < 4; ++probe)
        for (int time = 0; time < 2; ++time)
            bars.push_back({"probe " + std::to_string(probe) + ", time " + std::to_string(time), 1, false});
    const std::string few = bar_chart(bars, "t", "mm");
    EXPECT_THAT(few, AllOf(HasSubstr(">probe</text>"), HasSubstr(">3</text>"), HasSubstr("probe 3, time 1: 1 mm")));
    const auto count = [](const std::string& svg, const std::string& text) {
        std::size_t found = 0;
        for (std::size_t at = svg.find(text); at != std::string::npos; at = svg.find(text, at + 1)) ++found;
        return found;
    };
    EXPECT_EQ(count(few, ">3</text>"), 1U) << "once for both times";
    bars.clear();
    for (int probe = 100; probe < 400; ++probe) bars.push_back({"probe " + std::to_string(probe), 1, false});
    const std::size_t named = count(bar_chart(bars, "t", "mm"), R"(text-anchor="middle")");
    EXPECT_GT(named, 5U);
    EXPECT_LT(named, 20U);
}

TEST(PlainNumber, IsWrittenAsPeopleDo) {
    EXPECT_EQ(plain_number(14.093, 2), "14");
    EXPECT_EQ(plain_number(406.4, 2), "410");
    EXPECT_EQ(plain_number(0.13085, 2), "0.13");
    EXPECT_EQ(plain_number(0.0999, 2), "0.1");
    EXPECT_EQ(plain_number(2.0), "2");
    EXPECT_EQ(plain_number(1179.4), "1180");
    EXPECT_EQ(plain_number(-408037.0), "-408\u202f000");
    EXPECT_EQ(plain_number(0), "0");
    EXPECT_EQ(plain_number(3e-7, 2), "3e-07");
}

TEST(PrintedStiffness, IsInPlainWords) {
    EXPECT_EQ(printed_stiffness("flexion_2"), "bending stiffness, 2nd plane");
    EXPECT_EQ(printed_stiffness("flexion:link17"), "bending stiffness, link 17");
    EXPECT_EQ(printed_stiffness("elongation:zone2"), "elongation stiffness, zone 2");
    EXPECT_EQ(printed_stiffness("gravity"), "gravity");
}

/// Spheres and markers that stick out of the surface are within the picture, and the surface is where it was.
TEST(Pictures, HoldWhatSticksOut) {
    skeleton::Model model;
    model.surface = mesh::make_box({0, 0, 0}, {100, 20, 20}, {2, 1, 1});
    model.spheres.emplace_back();
    model.spheres.front().center = {5, 10, 10};
    model.spheres.front().radius = 40;
    const auto is_within = [](const std::string& svg) {
        double left = 0, top = 0, width = 0, height = 0;
        std::istringstream box(svg.substr(svg.find("viewBox=\"") + 9));
        box >> left >> top >> width >> height;
        const auto x = numbers_in(svg, "circle", "cx"), y = numbers_in(svg, "circle", "cy"),
                   r = numbers_in(svg, "circle", "r");
        EXPECT_FALSE(r.empty());
        for (std::size_t i = 0; i < r.size(); ++i) {
            EXPECT_GE(x[i] - r[i], left);
            EXPECT_LE(x[i] + r[i], left + width);
            EXPECT_GE(y[i] - r[i], top);
            EXPECT_LE(y[i] + r[i], top + height);
        }
    };
    const std::string spheres = skeleton_picture(model);
    is_within(spheres);
    const Dot out{{140, 10, 60}, 1}, inside{{5, 10, 10}, 1};
    const std::string dots = dot_picture(model, {out, inside}, 1, "mm");
    is_within(dots);
    const std::vector<double> x = numbers_in(dots, "circle", "cx");
    EXPECT_THAT(x, ::testing::Contains(numbers_in(spheres, "circle", "cx").front()))
        << "both pictures share the surface";
}

TEST(ConvergenceSection, ShowsWhatThereIs) {
    const TemporaryFolder folder;
    const std::string head = "stage,step,minus_log_density,temperature,effective_samples\n";
    const auto section = [&](const std::string& rows) {
        return convergence_section(folder.write("convergence.csv", head + rows));
    };
    EXPECT_THAT(section("fit,0,9,,\nfit,1,8,,\nparticles,0,,0,200\nparticles,1,,1,150\n"),
                AllOf(HasSubstr("optimiser"), HasSubstr("tempering exponent at 1: 1"), HasSubstr("effective samples")));
    EXPECT_THAT(section("particles,0,,0,200\nparticles,1,,1,150\n"), Not(HasSubstr("optimiser")));
    EXPECT_THAT(section("particles,0,,1,200\n"),
                AllOf(HasSubstr("Laplace"), HasSubstr("200 effective"), Not(HasSubstr("<svg"))));
    EXPECT_EQ(section(""), "");
}

}  // namespace
}  // namespace palpate::pipeline
