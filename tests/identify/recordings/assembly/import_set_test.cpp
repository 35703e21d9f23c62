// From three frames and two clocks to one measurement set.

#include "identify/recordings/assembly/import_set.h"

#include "mesh/text/atomic_file.h"
#include "tests/identify/recordings/assembly/rig_of_a_bar.h"

namespace palpate::identify {
namespace {

// Of a force [N]: 4 sd of means of some 2000 samples of a load cell; of 2 N also what a plateau keeps of its last
// flank.
constexpr double mean_force = 0.001, flank_force = 0.003;

TEST_F(RigOfABar, IsRegisteredWithinHalfTheNoiseAndTwoMilliseconds) {
    const ImportedSet got = imported();
    ASSERT_TRUE(got.report.registration);
    // fiducials stand on a frame of 50 mm: what the body's far end is off is the worst of it, a fifth of the noise
    for (const Vec3& at : {Vec3(0, 0, 0), Vec3(50, 10, 10), Vec3(100, 20, 20)}) {
        const Vec3 seen = R.transpose() * (at - t);
        EXPECT_LT((got.report.registration->motion(seen) - at).norm(), noise / 3) << at.transpose();
    }
    ASSERT_EQ(got.report.clocks.size(), 1U);
    EXPECT_NEAR(got.report.clocks[0].offset, lag, 0.002);  // [s]: 3.5 sd
    EXPECT_LT(got.report.clocks[0].sd, 7e-4);              // 0.6 ms
}

TEST_F(RigOfABar, BecomesStatesOfMeanPlacesAndForces) {
    const ImportedSet got = imported();
    const MeasurementSet& set = got.set;
    ASSERT_EQ(set.states.size(), 4U);
    ASSERT_EQ(set.markers.size(), markers.size());
    const double newtons[]{0, 1, 2, 0};
    for (std::size_t s = 0; s < 4; ++s) {
        const LoadState& state = set.states[s];
        ASSERT_EQ(state.contacts.size(), newtons[s] > 0 ? 1U : 0U) << s;
        if (newtons[s] > 0) {
            EXPECT_NEAR(state.contacts[0].force.z(), -newtons[s], flank_force);
            EXPECT_EQ(state.contacts[0].point, Vec3(100, 10, 20));
        }
        ASSERT_EQ(state.readings.size(), markers.size());
        for (std::size_t m = 0; m < markers.size(); ++m) {
            EXPECT_LT((state.readings[m].position - bent(markers[m], newtons[s])).norm(), noise / 2);  // as registered
            EXPECT_GT(state.readings[m].sigma, 0.0);
            EXPECT_LT(state.readings[m].sigma, noise / 5) << "means of some hundred samples";
        }
    }
    for (std::size_t m = 0; m < markers.size(); ++m) EXPECT_FALSE(set.markers[m].anchor) << "on the surface";
}

TEST_F(RigOfABar, IsReadBackAsItWasWritten) {
    const ImportedSet got = imported();
    write_measurement_set(folder / "set", got.set);
    const MeasurementSet back = read_measurement_set(folder / "set");
    EXPECT_EQ(back.states.size(), got.set.states.size());
    EXPECT_EQ(back.markers.size(), got.set.markers.size());
    EXPECT_EQ(back.states[1].readings[3].position, got.set.states[1].readings[3].position);
}

TEST_F(RigOfABar, IsMergedByATrigger) {
    change({{"{lag: auto}", "{trigger: sync}"},
            {"{file: points.csv,", "{file: points.csv, channels: [{column: sync, name: sync}],"},
            {"name: load, unit: N}", "name: load, unit: N}, {column: \"3\", name: sync, unit: V}"}});
    const ImportedSet got = imported();
    ASSERT_EQ(got.report.clocks.size(), 1U);
    const ClockReport& clock = got.report.clocks[0];
    EXPECT_NEAR(clock.offset + clock.rate * 4 - (lag + 4), 0,
                0.007);  // edges are seen by a sample of 10 ms, half of it late
    EXPECT_NEAR(clock.sd, std::hypot(0.01, 0.001) / std::sqrt(12) / std::sqrt(2),
                1e-9);  // two edges, by samples of both
    EXPECT_NEAR(got.set.states[2].contacts[0].force.z(), -2, flank_force);
}

TEST_F(RigOfABar, IsMergedByACommonColumn) {
    change({{"{lag: auto}", "{common: count}"},
            {"{file: points.csv,", "{file: points.csv, channels: [{column: count, name: count}],"},
            {"name: load, unit: N}", "name: load, unit: N}, {column: \"4\", name: count}"}});
    const ImportedSet got = imported();
    EXPECT_TRUE(says(got.report.clocks[0].how, {"common column 'count'"}));
    EXPECT_NEAR(got.set.states[1].contacts[0].force.z(), -1, mean_force);
}

TEST_F(RigOfABar, IsMergedByALagThatIsTold) {
    change("{lag: auto}", "{lag: 0.7321}");
    const ImportedSet got = imported();
    EXPECT_EQ(got.report.clocks[0].offset, 0.7321);
    EXPECT_NEAR(got.set.states[1].contacts[0].force.z(), -1, mean_force);
}

TEST_F(RigOfABar, TellsDisplacementsWhereTheseAreAskedFor) {
    change("states: plateaus", "readings: displacements");
    const ImportedSet got = imported();
    EXPECT_TRUE(got.set.states[0].readings.empty()) << "they count from here";
    const StateName rest{got.set.states[0].probe, got.set.states[0].time};
    for (const Reading& reading : got.set.states[1].readings) EXPECT_EQ(reading.since, rest);
    write_measurement_set(folder / "set", got.set);
    EXPECT_EQ(read_measurement_set(folder / "set").states[1].readings.size(), markers.size());
}

TEST_F(RigOfABar, IsToldItsLoadCellsDrift) {
    write_load("load.csv", 0.3);
    EXPECT_TRUE(says(all_notes(imported()), {"without load 'load' reads 0.2", "drifts"}));
}

TEST_F(RigOfABar, WithoutNamesIsRegisteredByItsSurface) {
    // a bar is symmetric, which is told; markers on it are near enough after all
    change(
        "fiducials:\n  - {name: clamp1, at: [-10, 0, 0]}\n  - {name: clamp2, at: [-10, 40, 0]}\n  - {name: clamp3, at: "
        "[-10, "
        "0, 50]}\n  - {name: clamp4, at: [-30, 10, 10]}\n",
        "markers: [{name: m1}, {name: m2}, {name: m3}, {name: m4}, {name: m5}, {name: m6}]\n");
    std::string text = mesh::read_text(folder / "map.yaml");
    const auto from = text.find(",\n      {name: clamp1"), to = text.find("]}\n  - {file: load");
    folder.write("map.yaml", text.erase(from, to - from));
    const ImportedSet got = imported();
    EXPECT_EQ(got.report.registration->points, 6);
    EXPECT_LT(got.report.registration->rms,
              noise / 8);  // of means of some hundred samples, of which six numbers fit most
    EXPECT_TRUE(says(all_notes(got), {"Another pose fits as well"}));
}

TEST_F(RigOfABar, KeepsTheHeightOfMarkersThatStandOff) {
    markers[1].z() = 26;
    write_points("points.csv", true);
    const ImportedSet got = imported();
    ASSERT_TRUE(got.set.markers[1].anchor);
    EXPECT_NEAR((*got.set.markers[1].anchor - Vec3(50, 5, 20)).norm(), 0,
                0.15 * noise);                                // along the skin, as registered
    EXPECT_NEAR(got.set.markers[1].rest.z(), 26, noise / 2);  // as registered
    EXPECT_TRUE(says(all_notes(got), {"1 of 6 markers stand off", "by 6"}));
}

TEST_F(RigOfABar, HasAStateEverySoOftenWhereThatIsAsked) {
    const ImportedSet every = import_set({.map = folder / "map.yaml", .files = {}, .states = "every=500ms"});
    EXPECT_EQ(every.set.states.size(), 18U);
    EXPECT_TRUE(says(message_of([&] { import_set({.map = folder / "map.yaml", .files = {}, .states = "often"}); }),
                     {"--states", "'often'", "every=0.1s"}));
}

TEST_F(RigOfABar, TakesFiducialsOutOfATable) {
    folder.write("places.csv", "name,x,y,z\nclamp1,-10,0,0\nclamp2,-10,40,0\nclamp3,-10,0,50\nclamp4,-30,10,10\n");
    change(
        "fiducials:\n  - {name: clamp1, at: [-10, 0, 0]}\n  - {name: clamp2, at: [-10, 40, 0]}\n  - {name: clamp3, at: "
        "[-10, "
        "0, 50]}\n  - {name: clamp4, at: [-30, 10, 10]}\n",
        "register: places.csv\n");
    const ImportedSet got = imported();
    EXPECT_EQ(got.report.registration->points, 4);
    EXPECT_EQ(got.set.markers.size(), 6U);
}

TEST_F(RigOfABar, NamesItsPointsByTheirDistances) {
    // the file's columns in another order than the map thinks
    std::string text = map();
    for (const auto& [a, b] : {std::pair{"clamp1", "clamp4"}, std::pair{"clamp2", "m2"}}) {
        const std::string first = std::string("{name: ") + a + ", at: [" + a,
                          second = std::string("{name: ") + b + ", at: [" + b;
        const auto at_a = text.find(first);
        text.replace(at_a, first.size(), std::string("{name: ") + b + ", at: [" + a);
        const auto at_b = text.find(second, text.find(second) == at_a ? at_a + 1 : 0);
        text.replace(at_b, second.size(), std::string("{name: ") + a + ", at: [" + b);
    }
    text.replace(text.find("{file: points.csv,"), 18, "{file: points.csv, order: unknown,");
    folder.write("map.yaml", text);
    const ImportedSet got = imported();
    EXPECT_LT(got.report.registration->rms, 2 * noise / std::sqrt(900));  // of means of 900 samples
    EXPECT_TRUE(says(all_notes(got), {"by their distances", "'clamp4'"}));
}

/// A file of image correlation: places at rest and the way from there.
struct CorrelatedBar : ::testing::Test {
    TemporaryFolder folder;
    ImportedSet imported(const std::string& rest, double first_way) const {
        mesh::write_surface(folder / "bar.stl", mesh::make_box({0, 0, 0}, {100, 20, 20}, {20, 4, 4}));
        std::string text = "frame,id,x,y,z,u,v,w\n";
        for (const auto& [frame, way] : {std::pair(0, first_way), std::pair(1, 2.0)})
            for (int p = 1; p <= 4; ++p)
                text += std::to_string(frame) + "," + std::to_string(p) + "," + std::to_string(20 * p) + ",10,20,0,0," +
                        std::to_string(-way * p) + "\n";
        folder.write("dic.csv", text);
        folder.write("map.yaml",
                     "name: bar\nmesh: bar.stl\nsupports:\n  - box: {min: [-1, -1, -1], max: [1, 21, 21]}\n"
                     "files:\n  - {file: dic.csv, rate: 1}\nregister: none\nstates: all\n" +
                         rest);
        return import_set({.map = folder / "map.yaml", .files = {}});
    }
};

TEST_F(CorrelatedBar, RestsWhereItsDisplacementsCountFrom) {
    const ImportedSet got = imported("", 0.5);
    ASSERT_EQ(got.set.markers.size(), 4u);
    EXPECT_TRUE(got.set.markers[1].rest.isApprox(Vec3(40, 10, 20)));
    ASSERT_EQ(got.set.states.size(), 2u);
    ASSERT_EQ(got.set.states[0].readings.size(), 4u);
    EXPECT_TRUE(got.set.states[0].readings[1].position.isApprox(Vec3(40, 10, 19)));
    // Where displacements are asked for they count from there, too.
    const ImportedSet displaced = imported("readings: displacements\n", 0.5);
    EXPECT_EQ(displaced.set.states[0].readings.size(), 4u);
    EXPECT_FALSE(displaced.set.states[0].readings[0].since);
}

TEST_F(CorrelatedBar, RestsInItsFirstStateWhereThatIsMeantOrTheSame) {
    EXPECT_TRUE(imported("rest: first\n", 0.5).set.markers[1].rest.isApprox(Vec3(40, 10, 19)));
    EXPECT_EQ(imported("", 0).set.states[0].readings.size(), 4u);  // the reference is a reading, with its noise
    EXPECT_TRUE(imported("rest: file\n", 0).set.markers[1].rest.isApprox(Vec3(40, 10, 20)));
}

}  // namespace
}  // namespace palpate::identify
