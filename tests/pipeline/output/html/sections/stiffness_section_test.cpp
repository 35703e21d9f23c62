// Densities of what is known before and after measuring, and the section of the report that shows them.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "pipeline/output/html/sections/stiffness_section.h"

namespace palpate::pipeline {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

/// Mean and sd of a log-normal whose logarithm has these.
identify::PosteriorRow log_normal_row(const std::string& name, double mean, double sd) {
    const double of_value = std::exp(mean + sd * sd / 2);
    return {name, -1, "N/mm", 1, 1, 0.5, 1, 2, of_value, of_value * std::sqrt(std::expm1(sd * sd)), true};
}

/// Particles of equal weight whose logarithms are normal, a column each.
ParticleSet normal_particles(const std::vector<std::string>& names, double mean, double sd, int count = 4000) {
    std::mt19937_64 random(1);
    std::normal_distribution<double> normal(mean, sd);
    ParticleSet set{names, Eigen::MatrixXd(count, std::ssize(names)), Eigen::VectorXd::Constant(count, 1.0 / count)};
    for (double& value : set.stiffness.reshaped()) value = std::exp(normal(random));
    return set;
}

/// Trapezoids.
double integral(const Density& density) {
    double sum = 0;
    for (std::size_t i = 1; i < density.size(); ++i) {
        const auto& [x, value] = density[i];
        const auto& [before, value_before] = density[i - 1];
        sum += (x - before) * (value + value_before) / 2;
    }
    return sum;
}

double highest_at(const Density& density) {
    return std::ranges::max_element(density, {}, [](const auto& point) { return point.second; })->first;
}

TEST(Density, OfParticlesIsTheirDistributions) {
    const auto row = log_normal_row("elongation", std::log(2), 0.6);
    const KnownBeforeAndAfter known =
        density_of(row, normal_particles({"elongation"}, std::log(3), 0.2), 0, PriorKind::log_normal);
    EXPECT_NEAR(integral(known.posterior), 1, 0.01);  // of 4000 particles, all within the axis
    EXPECT_NEAR(known.middle, 3, 0.03);               // 3 sd of a median of 4000: 3 * 1.25 * 0.2 / 63 of it
    EXPECT_NEAR(highest_at(known.posterior), std::log(3), 0.1);
    EXPECT_NEAR(highest_at(known.prior), std::log(2), 0.02);  // half a step of the grid
    for (const auto& [x, density] : known.prior) {
        const double z = (x - std::log(2)) / 0.6;
        EXPECT_NEAR(density, std::exp(-z * z / 2) / (0.6 * std::sqrt(2 * M_PI)), 1e-12);
    }
}

TEST(Density, CountsParticlesByTheirWeight) {
    ParticleSet particles = normal_particles({"elongation"}, 0, 0.1, 400);
    for (int i = 0; i < 200; ++i) particles.stiffness(i, 0) *= 10;  // half of them elsewhere, with no weight
    particles.weights.head(200).setZero();
    particles.weights /= particles.weights.sum();
    const KnownBeforeAndAfter known =
        density_of(log_normal_row("elongation", 0, 1), particles, 0, PriorKind::log_normal);
    EXPECT_LT(known.high, 2);
    EXPECT_NEAR(highest_at(known.posterior), 0, 0.1);
}

/// Of a box [0.5, 1.5] x by ln x is 1 per unit, and nothing beyond.
TEST(Density, OfAnEvenPriorEndsWithItsBox) {
    identify::PosteriorRow row = log_normal_row("elongation", 0, 1);
    row.prior_mean = 1;
    row.prior_sd = 1 / std::sqrt(12.0);
    const KnownBeforeAndAfter known = density_of(row, normal_particles({"elongation"}, 0, 0.3), 0, PriorKind::even);
    for (const auto& [x, density] : known.prior) {
        const double value = std::exp(x);
        if (std::abs(value - 0.5) < 1e-9 || std::abs(value - 1.5) < 1e-9) continue;
        EXPECT_NEAR(density, value > 0.5 && value < 1.5 ? value : 0, 1e-12) << value;
    }
}

TEST(Density, PoolsNumbersOverTheMiddlesOfTheirPriors) {
    const std::vector<identify::PosteriorRow> rows{log_normal_row("shear:link0", std::log(2), 0.5),
                                                   log_normal_row("shear:link1", std::log(50), 0.5)};
    ParticleSet particles = normal_particles({"shear:link0", "shear:link1"}, 0, 0.1);
    particles.stiffness.col(0) *= 2 * 1.5;
    particles.stiffness.col(1) *= 50 * 1.5;
    const KnownBeforeAndAfter known = pooled_density("shear", rows, particles, {0, 1}, PriorKind::log_normal);
    EXPECT_NEAR(known.middle, 1.5, 0.02);
    EXPECT_NEAR(highest_at(known.prior), 0, 0.02);
    EXPECT_NEAR(integral(known.posterior), 1, 0.01);
}

TEST(StiffnessSection, DrawsEachNumberWhereTheyAreFew) {
    const std::vector<identify::PosteriorRow> rows{log_normal_row("elongation", 0, 1), log_normal_row("flexion", 0, 1)};
    EXPECT_THAT(
        stiffness_section(rows, normal_particles({"elongation", "flexion"}, 0, 0.2), PriorKind::log_normal, "p"),
        AllOf(HasSubstr("x = elongation stiffness [N/mm]"), HasSubstr("x = bending stiffness [N/mm]"),
              HasSubstr("geometric mean"), Not(HasSubstr("<select"))));
}

TEST(StiffnessSection, PoolsManyAndLetsOneBeChosen) {
    std::vector<identify::PosteriorRow> rows;
    std::vector<std::string> names;
    for (int link = 0; link < 300; ++link) {
        names.push_back("shear:link" + std::to_string(link));
        rows.push_back(log_normal_row(names.back(), 0, 0.7));
        rows.back().informed = false;
    }
    rows[7].q025 = 0.99;  // the one that is known best leads the list
    rows[7].q975 = 1.01;
    const std::string html =
        stiffness_section(rows, normal_particles(names, 0, 0.2, 50), PriorKind::log_normal, "posterior.csv");
    EXPECT_THAT(html,
                AllOf(HasSubstr("shear stiffness, all 300"), HasSubstr("[× start value]"), HasSubstr("200 of 300"),
                      HasSubstr("<select id=\"density-of\"><option>shear stiffness, link 7<"),
                      HasSubstr(">shear, link 7</text>")));
    EXPECT_LT(html.size(), 1'000'000U);
}

/// As many digits as the interval leaves, and no exponents.
TEST(DensityChart, TellsTheMedianWithItsUnit) {
    KnownBeforeAndAfter known{.name = "torsion stiffness",
                              .unit = "N*mm/rad",
                              .prior = {{4, 1}, {13, 1}},
                              .posterior = {{4, 1}, {13, 1}},
                              .low = 115.29,
                              .middle = 1373.5,
                              .high = 408037};
    EXPECT_THAT(density_chart(known), AllOf(HasSubstr("median 1400 N·mm/rad (95 %: 120–410\u202f000)"),
                                            HasSubstr("x = torsion stiffness [N·mm/rad]"), Not(HasSubstr("e+"))));
    known.low = 1154.5;
    known.middle = 1179.4;
    known.high = 1231.7;
    EXPECT_THAT(density_chart(known), HasSubstr("median 1180 N·mm/rad (95 %: 1150–1230)"));
}

TEST(StiffnessSection, DoesWithoutParticles) {
    EXPECT_THAT(stiffness_section({log_normal_row("elongation", 0, 1)}, {}, PriorKind::log_normal, "p"),
                AllOf(HasSubstr("Intervals"), Not(HasSubstr("polyline"))));
}

}  // namespace
}  // namespace palpate::pipeline
