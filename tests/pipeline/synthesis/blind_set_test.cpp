// The parts that synthetic measurements are made of: what is specified, what a probe does in time, what readings lack.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "mesh/errors.h"
#include "pipeline/synthesis/effects/effect_sampler.h"
#include "pipeline/synthesis/loading/load_sequence.h"
#include "pipeline/synthesis/loading/probe_load_history.h"
#include "pipeline/synthesis/loading/reading_faults.h"
#include "tests/messages.h"

namespace palpate::pipeline {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

// --- what is specified ---

TEST(EffectSpec, ReadsBackWhatItWrites) {
    const skeleton::EffectRecord effect{"gravity",
                                        {{"gx", -4387.25, "mm/s^2"}, {"gy", 0.1, "mm/s^2"}, {"gz", 1e-30, ""}}};
    const auto read = read_specs({to_spec(effect)});
    ASSERT_EQ(read.size(), 1U);
    EXPECT_EQ(read[0].effect, "gravity");
    ASSERT_EQ(read[0].given.size(), 3U);
    for (std::size_t i = 0; i < 3; ++i) {
        EXPECT_EQ(read[0].given[i].name, effect.parameters[i].name);
        EXPECT_EQ(read[0].given[i].value, effect.parameters[i].value);  // the shortest text of a double is exact
    }
}

TEST(EffectSpec, TellsSlipsOfItsForm) {
    for (const char* good : {"gravity", "gravity:gz=-9810", "inclusion:ratio=8,radius=12"}) {
        EXPECT_THAT(objection_to_spec(good), IsEmpty()) << good;
    }
    for (const char* bad : {"", ":gz=1", "gravity:", "gravity:gz", "gravity:=3", "gravity:gz=1,"}) {
        EXPECT_THAT(objection_to_spec(bad), HasSubstr("gravity:gz=-9810")) << bad;
    }
}

TEST(EffectSpec, RefusesWhatCannotBeMeant) {
    const auto message = [](const std::vector<std::string>& specs) {
        return message_of<InvalidInput>([&] {
            for (const EffectSpec& spec : read_specs(specs)) check_spec(spec);
        });
    };
    EXPECT_TRUE(says(message({"gravty"}), {"gravty", "did you mean 'gravity'", "inclusion", "outliers"}));
    EXPECT_TRUE(says(message({"inclusion:raduis=3"}), {"inclusion", "raduis", "did you mean 'radius'"}));
    EXPECT_TRUE(says(message({"outliers:shore=3"}), {"outliers", "shore", "did you mean 'share'"}));
    EXPECT_TRUE(says(message({"gravity:gz=much"}), {"gravity", "gz", "much", "no number"}));
    EXPECT_TRUE(says(message({"gravity:gz=1,gz=2"}), {"gz", "twice"}));
    EXPECT_TRUE(says(message({"gravity", "gravity:gz=2"}), {"gravity", "twice"}));
    EXPECT_TRUE(says(message({"none", "gravity"}), {"none", "alone"}));
    EXPECT_NO_THROW(read_specs({"inclusion", "inclusion:ratio=3"})) << "a body may have several";
}

// --- what a probe does in time ---

TEST(ProbeLoadHistory, HoldsAndLetsGo) {
    const auto rows = rows_of({2.0, 3.0}, {.unload = true, .dwell = {0.5, 4}});
    const std::vector<std::pair<double, double>> expected{{0.5, 2}, {4, 2}, {4.5, 0}, {5, 3}, {8.5, 3}, {9, 0}};
    ASSERT_EQ(rows.size(), expected.size());
    for (std::size_t i = 0; i < rows.size(); ++i) {
        EXPECT_DOUBLE_EQ(rows[i].time, expected[i].first) << i;
        EXPECT_DOUBLE_EQ(rows[i].force, expected[i].second) << i;
    }
}

TEST(ProbeLoadHistory, GoesBackAsItCame) {
    const auto forces = [](const LoadTiming& timing) {
        std::vector<double> all;
        for (const Row& row : rows_of({1.0, 2.0, 3.0}, timing)) all.push_back(row.force);
        return all;
    };
    EXPECT_THAT(forces({.back = true, .dwell = {}}), ::testing::ElementsAre(1, 2, 3, 2, 1, 0));
    EXPECT_THAT(forces({.unload = true, .back = true, .dwell = {}}),
                ::testing::ElementsAre(1, 0, 2, 0, 3, 0, 2, 0, 1, 0));
}

TEST(ProbeLoadHistory, IsReadOnceAfterASecondUnlessTold) {
    const auto rows = rows_of({2.0, 3.0}, {});
    ASSERT_EQ(rows.size(), 2U);
    EXPECT_EQ(rows[0].time, 1);
    EXPECT_EQ(rows[1].time, 2);
}

TEST(ProbeLoadHistory, LevelsComeRoundInTurnUnlessAllAreAskedFor) {
    EXPECT_DOUBLE_EQ(levels_of(0, 0).at(0), 1.0 / 3);
    EXPECT_DOUBLE_EQ(levels_of(4, 0).at(0), 2.0 / 3);
    EXPECT_DOUBLE_EQ(levels_of(11, 0).at(0), 1);
    EXPECT_THAT(levels_of(5, 4), ::testing::ElementsAre(0.25, 0.5, 0.75, 1.0));
}

/// A load that is held since time 0 creeps as J(t); once it is let go, what it had crept comes back as it came.
TEST(ProbeLoadHistory, CreepSuperposes) {
    const fem::CreepLaw creep{0.7, 4};
    const auto J = [&](double t) { return 1 + creep.creep * (1 - std::exp(-t / creep.tau)); };
    constexpr double rounding = 1e-14;  // of sums of up to five terms below 10
    const ProbeLoadHistory history{1, {}, rows_of({2.0, 5.0}, {.unload = true, .dwell = {1, 10}})};
    // rows at 1, 10 (2 N), 11 (0), 12, 21 (5 N), 22 (0); a row's force acts since the row before it
    EXPECT_NEAR(history.effective_force(0, creep), 2 * J(1), rounding);
    EXPECT_NEAR(history.effective_force(1, creep), 2 * J(10), rounding);
    EXPECT_NEAR(history.effective_force(2, creep), 2 * J(11) - 2 * J(1), rounding);
    EXPECT_NEAR(history.effective_force(4, creep), 2 * J(21) - 2 * J(11) + 5 * J(10), rounding);
    EXPECT_DOUBLE_EQ(history.effective_force(4, std::nullopt), 5);
}

/// Loads change evenly from row to row, the first from time 0 on; the last one stays.
TEST(ProbeLoadHistory, LagsByInterpolation) {
    const ProbeLoadHistory history{1, {}, rows_of({2.0, 5.0}, {.unload = true, .dwell = {}})};
    // rows at 1 (2 N), 2 (0), 3 (5 N), 4 (0)
    EXPECT_DOUBLE_EQ(history.lagged_force(0, 0.25, {}), 1.5);
    EXPECT_DOUBLE_EQ(history.lagged_force(1, 0.25, {}), 0.5);
    EXPECT_DOUBLE_EQ(history.lagged_force(2, 1.5, {}), 1);
    EXPECT_DOUBLE_EQ(history.lagged_force(3, -0.5, {}), 0);
    EXPECT_DOUBLE_EQ(history.lagged_force(0, 3, {}), 0);
    EXPECT_DOUBLE_EQ(history.lagged_force(2, 0, {}), 5);
}

TEST(Sequence, AnErrorOfClocksIsGivenLoadsThatChange) {
    const Sequence clock = sequence_of({}, read_specs({"clock"}));
    EXPECT_EQ(clock.levels, 3);
    EXPECT_TRUE(clock.timing.unload);
    EXPECT_FALSE(clock.continuous);
    EXPECT_EQ(sequence_of({}, read_specs({"gravity"})).levels, 0);
    BlindSetOptions told;
    told.levels = 5;
    told.unload = false;
    EXPECT_EQ(sequence_of(told, read_specs({"clock"})).levels, 5);
    EXPECT_FALSE(sequence_of(told, read_specs({"clock"})).timing.unload);
}

TEST(Sequence, DamageIsLedBackToLessThanItBore) {
    const Sequence damage = sequence_of({}, read_specs({"damage"}));
    EXPECT_EQ(damage.levels, 2);
    EXPECT_TRUE(damage.timing.back && damage.continuous);
    EXPECT_FALSE(damage.timing.unload);
    ASSERT_EQ(damage.notes.size(), 1U);
    EXPECT_THAT(damage.notes.front(), HasSubstr("Damage shows where less is borne after more"));
    BlindSetOptions told;
    told.levels = 4;
    told.back = true;
    told.continuous = false;
    EXPECT_EQ(sequence_of(told, read_specs({"damage"})).levels, 4);
    EXPECT_TRUE(sequence_of(told, read_specs({"damage"})).notes.empty());
    EXPECT_EQ(sequence_of(told, read_specs({"stiffening"})).continuous, false);
    EXPECT_TRUE(sequence_of(told, read_specs({"stiffening"})).timing.back);
    told.back = false;
    EXPECT_FALSE(sequence_of(told, read_specs({"damage"})).timing.back);
}

TEST(Sequence, EffectsThatRememberAreGivenTime) {
    const auto of = [](const char* spec, const BlindSetOptions& options = {}) {
        return sequence_of(options, read_specs({spec}));
    };
    EXPECT_FALSE(of("gravity").timing.unload);
    EXPECT_TRUE(of("plasticity").timing.unload && of("plasticity").continuous);
    EXPECT_EQ(of("plasticity").notes.size(), 1U);
    EXPECT_THAT(of("viscosity").timing.dwell, ::testing::ElementsAre(0.1, 4, 20));
    BlindSetOptions told;
    told.unload = false;
    told.continuous = false;
    told.dwell = {3};
    EXPECT_FALSE(of("plasticity", told).timing.unload || of("plasticity", told).continuous);
    EXPECT_THAT(of("viscosity", told).timing.dwell, ::testing::ElementsAre(3));
}

TEST(BlindSetOptions, NameWhatIsOutOfRange) {
    const auto message = [](BlindSetOptions options) { return message_of<InvalidInput>([&] { options.validate(); }); };
    EXPECT_TRUE(says(message({.levels = -1}), {"levels", "-1"}));
    EXPECT_TRUE(says(message({.dwell = {2, 1}}), {"dwell", "2, 1", "rise"}));
    EXPECT_TRUE(says(message({.dwell = {0}}), {"dwell", "0"}));
    EXPECT_TRUE(says(message({.noise = -0.1}), {"noise", "-0.1"}));
    EXPECT_TRUE(says(message({.missing = 0.95}), {"missing", "0.95"}));
    EXPECT_TRUE(says(message({.unlabelled = 1.5}), {"unlabelled", "1.5"}));
}

// --- what readings lack ---

constexpr int many = 4000;

/// Markers on a line, so that a reading tells which one it was.
Points line() {
    Points positions = Points::Zero(many, 3);
    for (int m = 0; m < many; ++m) positions(m, 0) = 1000.0 * m;
    return positions;
}

TEST(Readings, AreExactWithoutFaults) {
    const auto readings = read_markers({.probe = 3, .time = 1}, line(), {}, 1);
    ASSERT_EQ(readings.size(), static_cast<std::size_t>(many));
    for (const auto& reading : readings) EXPECT_EQ(reading.position.x(), 1000.0 * reading.marker);
}

TEST(Readings, NoiseHasTheSizeThatItIsTold) {
    double squares = 0;
    for (const auto& r : read_markers({.probe = 3, .time = 1}, line(), {.noise = 0.2}, 1)) {
        squares += (r.position - Vec3(1000.0 * r.marker, 0, 0)).squaredNorm();
    }
    // 12,000 squares: their mean is known to sqrt(2 / 12000) = 1.3 %; 4 of those
    EXPECT_NEAR(squares / (3 * many * 0.04), 1, 0.052);
}

TEST(Readings, SharesAreMissingUnlabelledAndWild) {
    const ReadingFaults faults{
        .noise = 0.01, .outlier_share = 0.06, .outlier_width = 25, .missing = 0.1, .unlabelled = 0.2};
    const auto readings = read_markers({.probe = 3, .time = 1}, line(), faults, 5);
    int unlabelled = 0, wild = 0;
    for (const auto& r : readings) {
        unlabelled += r.marker < 0;
        const double off = (r.position - Vec3(1000 * std::round(r.position.x() / 1000), 0, 0)).norm();
        wild += off > 0.05;  // 5 sigma; a wild one is within that once in some 50
    }
    // binomial: 4 sigma of 4000 draws
    EXPECT_NEAR(static_cast<double>(readings.size()) / many, 0.9, 0.019);
    EXPECT_NEAR(unlabelled / static_cast<double>(readings.size()), 0.2, 0.027);
    EXPECT_NEAR(wild / static_cast<double>(readings.size()), 0.06, 0.018);
}

/// The order of readings without a label tells nothing of their markers.
TEST(Readings, WithoutALabelComeInAnyOrder) {
    const auto readings = read_markers({.probe = 3, .time = 1}, line(), {.unlabelled = 1}, 5);
    int rises = 0;
    for (std::size_t i = 1; i < readings.size(); ++i) {
        rises += readings[i].position.x() > readings[i - 1].position.x();
    }
    EXPECT_NEAR(rises / static_cast<double>(many), 0.5, 0.03);  // sd 0.5/sqrt(3 * 4000) = 0.0046 in a random order
}

/// A fault draws for itself: another beside it changes no number of it.
TEST(Readings, FaultsDoNotChangeEachOther) {
    const identify::LoadState state{.probe = 3, .time = 1};
    const auto plain = read_markers(state, line(), {.noise = 0.2}, 1);
    const auto gappy = read_markers(state, line(), {.noise = 0.2, .missing = 0.3}, 1);
    for (const auto& r : gappy) EXPECT_EQ(r.position, plain[r.marker].position);
    const auto other = read_markers({.probe = 3, .time = 2}, line(), {.noise = 0.2}, 1);
    EXPECT_NE(plain[0].position, other[0].position);
}

}  // namespace
}  // namespace palpate::pipeline
