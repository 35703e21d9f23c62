#include <gtest/gtest.h>

#include "identify/loading/loads.h"
#include "tests/identify/measurement_set_files.h"

namespace palpate::identify {
namespace {

/// The set of the other tests, and its body let go once.
struct RecordingFiles : MeasurementSetFiles {
    RecordingFiles() {
        folder.write("motion_probes.csv", loads);
        folder.write("motion_positions.csv", moved);
    }
    const std::string loads =
        "probe,time,x,y,z,fx,fy,fz,radius\n"
        "4,0,100,10,20,0,0,-2,3\n"
        "4,2,0,0,0,0,0,0,0\n";
    const std::string moved =
        "probe,time,marker,x,y,z,sigma\n"
        "4,0,7,100,10,18,\n"
        "4,0.01,7,100,10,18.5,0.2\n"
        "4,0.02,7,100,,19,\n";
};

TEST_F(RecordingFiles, AreReadInTheSetsUnits) {
    std::string text = yaml;
    text.replace(text.find("force: N"), 8, "force: mN");
    folder.write("set.yaml", text);
    const MeasurementSet set = read();
    ASSERT_EQ(set.recordings.size(), 1U);
    const MotionRecording& recording = set.recordings[0];
    EXPECT_EQ(recording.probe, 4);
    ASSERT_EQ(recording.loads.size(), 2U);
    EXPECT_DOUBLE_EQ(recording.loads[0].contacts.at(0).force.z(), -0.002);
    EXPECT_TRUE(recording.loads[1].contacts.empty());
    ASSERT_EQ(recording.instants.size(), 3U);
    EXPECT_DOUBLE_EQ(recording.instants[1].time, 0.01);
    EXPECT_DOUBLE_EQ(recording.instants[1].readings.at(0).sigma, 0.2);
    EXPECT_TRUE(std::isnan(recording.instants[2].readings.at(0).position.y()));
    EXPECT_EQ(set.states.size(), 2U);  // the equilibria are what they were
}

TEST_F(RecordingFiles, AreWrittenAsTheyWereRead) {
    const MeasurementSet set = read();
    write_measurement_set(folder / "copy", set);
    const MeasurementSet copy = read_measurement_set(folder / "copy");
    ASSERT_EQ(copy.recordings.size(), 1U);
    EXPECT_EQ(copy.recordings[0].loads.size(), 2U);
    ASSERT_EQ(copy.recordings[0].instants.size(), 3U);
    EXPECT_EQ(copy.recordings[0].instants[1].readings[0].position, set.recordings[0].instants[1].readings[0].position);
}

TEST_F(RecordingFiles, TellWhatIsWrongWithThem) {
    EXPECT_TRUE(says(refusal("motion_positions.csv", "probe,time,marker,x,y,z\n5,0,7,1,1,1\n"),
                     {"motion_positions.csv, line 2", "probe 5", "motion_probes.csv"}));
    EXPECT_TRUE(
        says(refusal("motion_positions.csv", "probe,time,marker,x,y,z\n4,0,,1,1,1\n"), {"line 2", "no marker"}));
    EXPECT_TRUE(says(refusal("motion_positions.csv", "probe,time,marker,x,y,z\n4,1,7,1,1,1\n4,0.5,7,1,1,1\n"),
                     {"line 3", "0.5 comes after 1"}));
    EXPECT_TRUE(says(refusal("motion_positions.csv", "probe,time,marker,x,y,z\n4,1,7,1,1,1\n4,1,7,1,1,1\n"),
                     {"line 3", "marker 7 was read already"}));
    EXPECT_TRUE(says(refusal("motion_positions.csv", "probe,time,marker,x,y,z\n"), {"probe 4", "no readings"}));
    folder.write("motion_positions.csv", moved);
    EXPECT_TRUE(says(refusal("motion_probes.csv", "probe,time,x,y,z,fx,fy,fz,radius\n4,0,100,10,900,0,0,-2,3\n"),
                     {"motion_probes.csv", "off the rest surface"}));
}

TEST_F(RecordingFiles, OneWithoutTheOtherIsMissed) {
    std::filesystem::remove(folder / "motion_positions.csv");
    EXPECT_TRUE(says(message_of<IoError>([&] { read(); }), {"motion_positions.csv"}));
}

TEST(LoadsOfAMotion, ActFromTheOneBeforeThemOn) {
    const LoadState first{.probe = 1, .time = 0}, second{.probe = 1, .time = 0.5}, third{.probe = 1, .time = 2};
    const std::vector<const LoadState*> loads{&first, &second, &third};
    EXPECT_EQ(acting_before(loads), &first);
    EXPECT_EQ(acting_at(loads, 0.1), &second);
    EXPECT_EQ(acting_at(loads, 0.5), &second);
    EXPECT_EQ(acting_at(loads, 0.6), &third);
    EXPECT_EQ(acting_at(loads, 9), &third);
    EXPECT_EQ(acting_before({&second, &third}), nullptr);
    EXPECT_EQ(acting_before({&first}), nullptr);  // a load that begins with the motion
}

}  // namespace
}  // namespace palpate::identify
