#include <gtest/gtest.h>

#include <algorithm>

#include "tests/identify/recordings/read_sample.h"
#include "tests/identify/recordings/text_samples.h"
#include "tests/temporary_folder.h"

namespace palpate::identify {
namespace {

TEST(Trc, HoldsMarkersAndTimes) {
    const Recording run = only_recording("run.trc", trc_sample);
    EXPECT_EQ(run.format, "TRC, motion capture");
    ASSERT_EQ(run.points.size(), 2u);
    EXPECT_EQ(run.points[1].name, "Tip");
    EXPECT_DOUBLE_EQ(run.points[1].at(0, 0), 40);  // 4 cm
    EXPECT_TRUE(run.points[1].at.col(1).array().isNaN().all());
    EXPECT_DOUBLE_EQ(run.times[2], 0.02);
    EXPECT_TRUE(run.has_clock);
}

TEST(Trc, MayBeSeparatedByTwoTabs) {
    const Recording run = read_sample(
        "PathFileType\t4\t(X/Y/Z)\trun.trc\nDataRate\tCameraRate\tNumFrames\tNumMarkers\tUnits\n"
        "100.0\t\t100.0\t\t2\t\t1\t\tcm\nFrame#\tTime\tBase\t\t\n\t\tX1\tY1\tZ1\n\n1\t0\t1\t2\t3\n2\t0.01\t1\t2\t4\n");
    ASSERT_EQ(run.points.size(), 1u);
    EXPECT_EQ(run.points[0].at.col(1), Eigen::Vector3d(10, 20, 40));
}

TEST(Trc, SaysWhereItIsBroken) {
    EXPECT_TRUE(says(refusal_of("PathFileType\t4\n"), {"cut off"}));
    EXPECT_TRUE(says(refusal_of(replaced(trc_sample, "\t2\tcm", "\t3\tcm")), {"3 markers", "names 2"}));
    EXPECT_TRUE(says(refusal_of(replaced(trc_sample, "4.1", "4,x")), {"line 9", "Tip x", "4,x", "no number"}));
    EXPECT_TRUE(says(refusal_of(replaced(trc_sample, "\tcm\t", "\tparsec\t")), {"parsec", "no unit of length"}));
    EXPECT_TRUE(says(refusal_of(replaced(trc_sample, "0.02\t", "0.005\t")), {"line 9", "time runs backwards"}));
}

TEST(Motive, TakesMarkersAndLeavesBodiesOut) {
    const Recording take = only_recording("take.csv", motive_sample);
    EXPECT_EQ(take.format, "OptiTrack Motive, CSV");
    ASSERT_EQ(take.points.size(), 2u);
    EXPECT_EQ(take.points[0].name, "Plate:Marker1");
    // The measured marker, not the place that the rigid body solves for.
    EXPECT_DOUBLE_EQ(take.points[0].at(0, 0), 110);
    EXPECT_DOUBLE_EQ(take.points[1].at(2, 1), 330);
    EXPECT_TRUE(take.points[1].at.col(0).array().isNaN().all());
    EXPECT_DOUBLE_EQ(take.times[1], 0.0041667);
    EXPECT_TRUE(notes_tell(take, "Rigid Body"));
}

TEST(Motive, TimecodesAreNoNumbers) {
    const Recording take = read_sample(
        "Format Version,1.24,Length Units,Centimeters\n\n,Type,,Marker,Marker,Marker\n,Name,,a,a,a\n,ID,,1,1,1\n"
        ",,,Position,Position,Position\nFrame,Time (Seconds),TimeCode,X,Y,Z\n0,0.0,15:26:46:12.02,1,2,3\n"
        "1,0.01,15:26:46:12.03,1,2,4\n");
    ASSERT_EQ(take.points.size(), 1u);
    EXPECT_EQ(take.points[0].at.col(1), Eigen::Vector3d(10, 20, 40));
}

TEST(Motive, PivotsOfBodiesStandInForMarkers) {
    const Recording take = read_sample(
        "Format Version,1.23,Length Units,Meters\n\n,Type,Rigid Body,Rigid Body,Rigid Body,Rigid Body,Rigid Body,Rigid "
        "Body,Rigid Body\n,Name,pad,pad,pad,pad,pad,pad,pad\n,ID,1,1,1,1,1,1,1\n"
        ",,Rotation,Rotation,Rotation,Rotation,Position,Position,Position\nFrame,Time "
        "(Seconds),X,Y,Z,W,X,Y,Z\n0,0.0,0,0,0,1,0.1,0.2,0.3\n1,0.01,0,0,0,1,0.1,0.2,0.4\n");
    ASSERT_EQ(take.points.size(), 1u);
    EXPECT_EQ(take.points[0].name, "pad");
    EXPECT_TRUE(take.points[0].at.col(1).isApprox(Eigen::Vector3d(100, 200, 400)));
    EXPECT_TRUE(notes_tell(take, "pivots of rigid bodies"));
}

TEST(Motive, SaysWhatIsMissing) {
    EXPECT_TRUE(says(refusal_of(replaced(motive_sample, ",Type,", ",Kind,")), {"'Type'", "header information"}));
    EXPECT_TRUE(says(refusal_of(replaced(motive_sample, "Meters", "Feetish")), {"Feetish", "no unit of length"}));
    std::string no_markers = motive_sample;
    for (const char* kind : {"Rigid Body Marker", "Rigid Body", "Marker"})
        while (no_markers.find(kind) != std::string::npos) no_markers = replaced(no_markers, kind, "Bone");
    EXPECT_TRUE(says(refusal_of(no_markers), {"holds no markers", "Bone"}));
}

TEST(Vicon, HoldsTrajectoriesDevicesAndEventsOnTheirClocks) {
    const TemporaryFolder folder;
    const auto recordings = read_recordings(folder.write("trial.csv", vicon_sample));
    ASSERT_EQ(recordings.size(), 3u);
    const Recording& points = recordings[0];
    ASSERT_EQ(points.points.size(), 2u);
    EXPECT_EQ(points.points[0].name, "Arm:LASI");
    EXPECT_DOUBLE_EQ(points.points[1].at(1, 1), 5.5);
    EXPECT_DOUBLE_EQ(points.times[1], 0.01);
    ASSERT_EQ(points.events.size(), 1u);
    EXPECT_DOUBLE_EQ(points.events[0].time, 0.015);

    const auto devices = std::ranges::find(recordings, "trial.csv, devices", &Recording::source);
    ASSERT_NE(devices, recordings.end());
    ASSERT_EQ(devices->channels.size(), 2u);
    EXPECT_EQ(devices->channels[0].name, "Plate - Force Fx");
    EXPECT_EQ(devices->channels[1].unit, "N*mm");
    EXPECT_DOUBLE_EQ(devices->times[3], 0.015);  // frame 2, sub frame 1, two of them a frame, 200 a second

    const auto models = std::ranges::find(recordings, "trial.csv, model outputs", &Recording::source);
    ASSERT_NE(models, recordings.end());
    EXPECT_EQ(models->channels[0].unit, "rad");
}

TEST(Vicon, SaysWhereItIsBroken) {
    EXPECT_TRUE(says(refusal_of("Trajectories\n100\n"), {"line 1", "cut off"}));
    EXPECT_TRUE(
        says(refusal_of(replaced(vicon_sample, "Trajectories\n100", "Trajectories\nfast")), {"fast", "above 0"}));
    EXPECT_TRUE(says(refusal_of(replaced(vicon_sample, "2,0,1.1", "1,0,1.1")), {"frames run backwards"}));
    EXPECT_TRUE(says(refusal_of(replaced(vicon_sample, "2,0,1.1", "2,0,12.05.2024")), {"12.05.2024", "a date"}));
    EXPECT_TRUE(says(refusal_of("Joints\n100\nx\n"), {"neither trajectories"}));
}

}  // namespace
}  // namespace palpate::identify
