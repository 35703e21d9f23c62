// Three laboratories' own files become sets, with nothing but a map.

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>

#include "identify/recordings/assembly/import_set.h"
#include "tests/messages.h"
#include "tests/places.h"
#include "tests/temporary_folder.h"

namespace palpate::identify {
namespace {

namespace fs = std::filesystem;

struct Rigs : ::testing::Test {
    void SetUp() override {
        const char* data = std::getenv("PALPATE_DATA");
        if (!data || !fs::exists(fs::path(data) / "rigs"))
            GTEST_SKIP() << "PALPATE_DATA names no folder of rigs' files";
        rigs = fs::path(data) / "rigs";
    }
    /// Imported, written and read back.
    MeasurementSet set_of(const std::string& rig) {
        got = import_set({.map = fs::path(samples_folder) / "import" / rig / "map.yaml", .files = {rigs / rig}});
        write_measurement_set(scratch / rig, got.set);
        return read_measurement_set(scratch / rig);
    }
    bool is_noted(const std::string& words) const {
        for (const std::string& note : got.report.notes)
            if (note.find(words) != std::string::npos) return true;
        return false;
    }

    fs::path rigs;
    TemporaryFolder scratch;
    ImportedSet got;
};

TEST_F(Rigs, APneumaticArmIsFourProbesOfRisingPressure) {
    const MeasurementSet set = set_of("pneumatic-arm");
    ASSERT_TRUE(got.report.registration);
    EXPECT_EQ(got.report.registration->points, 4);
    EXPECT_LT(got.report.registration->rms, 1.2);  // the clamp's markers stood that far from their places
    ASSERT_EQ(set.markers.size(), 3U);
    double before = 0;
    for (int probe = 1; probe <= 4; ++probe) {
        double pressure = 0, moved = 0;
        int unloaded = 0;
        for (const LoadState& state : set.states) {
            if (state.probe != probe) continue;
            unloaded += state.actuations.empty() ? 1 : 0;
            for (const Actuation& actuation : state.actuations) pressure = actuation.value;
            if (!state.actuations.empty() && !state.readings.empty())
                moved = (state.readings[0].position - set.markers[0].rest).norm();
        }
        EXPECT_GE(unloaded, 1) << probe;
        EXPECT_DOUBLE_EQ(pressure, 0.01 * probe) << probe;  // 100 mbar are 0.01 MPa
        EXPECT_GT(moved, before) << probe;
        before = moved;
    }
    EXPECT_NEAR(before, 37.3, 0.4);  // [mm] at 400 mbar, by the last plateau of its file
    EXPECT_TRUE(is_noted("plateaus drift")) << "the segment creeps";
    EXPECT_TRUE(std::ranges::any_of(set.notes, [](const std::string& note) {
        return note.find("carved out of the body") != std::string::npos;
    })) << "the chamber is in a file of its own";
}

TEST_F(Rigs, ATentaclesMarkersAreFoundInEveryFile) {
    const MeasurementSet set = set_of("tentacle");
    ASSERT_EQ(set.states.size(), 4U);
    ASSERT_EQ(set.markers.size(), 4U);
    EXPECT_TRUE(is_noted("m1_u01.csv") && is_noted("c is 'four'")) << "order 1, 3, 4, 2, base";
    for (const LoadState& state : set.states) {
        ASSERT_EQ(state.readings.size(), 4U);
        ASSERT_EQ(state.actuations.size(), 1U);
        EXPECT_EQ(state.actuations[0].actuator, state.probe <= 2 ? 0 : 1);
        // 0.1 and 0.2 N m on a spool of 32.5 mm
        EXPECT_DOUBLE_EQ(state.actuations[0].value, (state.probe % 2 == 1 ? 100 : 200) / 32.5);
        // the first tendon pulls to +y, the second to -y, and the markers go there, the tip most
        const double side = state.probe <= 2 ? 1 : -1;
        const auto moved = [&](int marker) {
            const auto reading = std::ranges::find(state.readings, marker, &Reading::marker);
            return Vec3(reading->position - set.markers[static_cast<std::size_t>(marker)].rest);
        };
        // [mm], as the files hold them: 114 and more at the tip, 21 and less at the base
        EXPECT_GT(side * moved(3).y(), 90);
        EXPECT_LT(moved(0).norm(), 26);
        EXPECT_NEAR(side * moved(0).y(), 0, 20);
    }
}

TEST_F(Rigs, SkinIsASheetWhosePadMovesAndAnswers) {
    const MeasurementSet set = set_of("skin");
    ASSERT_EQ(set.markers.size(), 544U);
    ASSERT_GE(set.states.size(), 5U);
    ASSERT_EQ(set.tools.size(), 1U);
    double before = 1;
    for (const LoadState& state : set.states) {
        ASSERT_EQ(state.motions.size(), 1U);
        EXPECT_LT(state.motions[0].translation.x(), before);  // ever further to -x
        before = state.motions[0].translation.x();
        EXPECT_EQ(state.readings.size(), 544U);
        EXPECT_TRUE(std::isnan(state.readings[0].position.z())) << "one camera sees two coordinates";
    }
    EXPECT_NEAR(before, -3.36, 0.1);  // [mm], by the pad's own log at the last plateau
    for (const LoadState& state : set.states)
        for (const Reading& reading : state.readings)
            EXPECT_GT(reading.sigma, 4e-3) << "a track that froze, or one frame";  // [mm]; 0.0056 and more
    const LoadState& last = set.states.back();
    ASSERT_EQ(last.reactions.size(), 1U);
    EXPECT_LT(last.reactions[0].force.x(), -0.1);  // [N], as the log holds it: -0.13
    EXPECT_TRUE(std::isnan(last.reactions[0].force.y())) << "the load cell reads one axis";
    EXPECT_EQ(got.report.clocks.size(), 3U);
}

}  // namespace
}  // namespace palpate::identify
