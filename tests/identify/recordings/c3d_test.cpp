#include <gtest/gtest.h>

#include <cmath>

#include "identify/recordings/files/read_recordings.h"
#include "tests/identify/recordings/c3d_sample.h"
#include "tests/messages.h"
#include "tests/temporary_folder.h"

namespace palpate::identify {
namespace {

using Processor = C3dSample::Processor;

struct Kind {
    const char* name;
    Processor processor;
    bool has_reals;
};

class C3d : public testing::TestWithParam<Kind> {};

TEST(C3dFile, MayTellWhereItsDataBeginInTheHeaderAlone) {
    const C3dSample sample;
    std::string bytes = sample.bytes();
    bytes.replace(bytes.find("DATA_START") + 10 + 2 + 2, 2, 2, '\0');
    const TemporaryFolder folder;
    const Recording told = read_recordings(folder.write("a.c3d", sample.bytes()))[0],
                    untold = read_recordings(folder.write("b.c3d", bytes))[0];
    EXPECT_EQ(untold.points[1].at.col(2), told.points[1].at.col(2));
}

TEST_P(C3d, HoldsPointsAnalogsAndEventsWhateverWroteIt) {
    C3dSample sample(GetParam().processor);
    sample.has_reals = GetParam().has_reals;
    const TemporaryFolder folder;
    const auto recordings = read_recordings(folder.write("run.c3d", sample.bytes()));
    ASSERT_EQ(recordings.size(), 2u);

    // Integers are scaled by 0.5, reals are not; a metre has 1000 mm.
    const double unit = sample.has_reals ? 1000 : 500;
    const Recording& points = recordings[0];
    ASSERT_EQ(points.points.size(), 2u);
    EXPECT_EQ(points.points[0].name, "Base");
    EXPECT_EQ(points.points[1].name, "Tip");
    EXPECT_TRUE(points.points[1].at.col(2).isApprox(unit * Eigen::Vector3d(12, 2, 3), 1e-7));  // reals of 24 bits
    EXPECT_TRUE(points.points[1].at.col(1).array().isNaN().all());  // a residual of -1: not seen
    EXPECT_TRUE(points.points[0].at.allFinite());
    ASSERT_EQ(points.times.size(), 3);
    EXPECT_TRUE(points.has_clock);
    EXPECT_DOUBLE_EQ(points.times[2], 0.02);
    ASSERT_EQ(points.events.size(), 1u);
    EXPECT_EQ(points.events[0].name, "Touch");
    EXPECT_NEAR(points.events[0].time, 0.02, 1e-9);  // a real of 24 bits: 2^-25 of it

    const Recording& analogs = recordings[1];
    ASSERT_EQ(analogs.channels.size(), 2u);
    EXPECT_EQ(analogs.channels[0].name, "Fz");
    EXPECT_EQ(analogs.channels[0].unit, "N");  // told in kN
    EXPECT_EQ(analogs.channels[1].unit, "V");
    ASSERT_EQ(analogs.channels[0].values.size(), 6);
    // (raw - offset) scale gen_scale, sample 5 of frame 2: raw 5
    EXPECT_DOUBLE_EQ(analogs.channels[0].values[5], (5 - 4) * 0.25 * 2 * 1000);
    EXPECT_DOUBLE_EQ(analogs.channels[1].values[5], 15 * 2);
    EXPECT_DOUBLE_EQ(analogs.times[5], 5 / 200.);
}

INSTANTIATE_TEST_SUITE_P(
    Of, C3d,
    testing::Values(Kind{"IntelReals", Processor::intel, true}, Kind{"IntelIntegers", Processor::intel, false},
                    Kind{"DecReals", Processor::dec, true}, Kind{"DecIntegers", Processor::dec, false},
                    Kind{"MipsReals", Processor::mips, true}, Kind{"MipsIntegers", Processor::mips, false}),
    [](const auto& each) { return each.param.name; });

TEST(C3dFile, IsRecognisedByItsContent) {
    const TemporaryFolder folder;
    EXPECT_EQ(read_recordings(folder.write("run.txt", C3dSample().bytes()))[0].format, "C3D, points");
}

TEST(C3dFile, FirstFrameSetsTheClock) {
    C3dSample sample;
    sample.first_frame = 51;
    const TemporaryFolder folder;
    const auto recordings = read_recordings(folder.write("run.c3d", sample.bytes()));
    EXPECT_DOUBLE_EQ(recordings[0].times[0], 0.5);
    EXPECT_DOUBLE_EQ(recordings[1].times[0], 0.5);
}

TEST(C3dFile, ParametersEndWithTheirSection) {
    // As in files from SGI's machines: the last record's offset leads far beyond what the section's length says.
    for (const auto processor : {C3dSample::Processor::intel, C3dSample::Processor::mips}) {
        const C3dSample sample(processor);
        std::string bytes = sample.bytes();
        const std::size_t last = bytes.find("TIMES") + 5;
        bytes.replace(last, 2, sample.integer(16129));
        bytes.append(20000, '\x7F');  // so that there is something to run into
        const TemporaryFolder folder;
        const auto recordings = read_recordings(folder.write("run.c3d", bytes));
        ASSERT_EQ(recordings[0].points.size(), 2u);
        EXPECT_EQ(recordings[0].points[0].name, "Base");
    }
}

TEST(C3dFile, MapTellsUnitRateAndNames) {
    FileMap map;
    map.unit = "mm";
    map.rate = 50;
    map.names = {"a", "b"};
    const TemporaryFolder folder;
    const auto recordings = read_recordings(folder.write("run.c3d", C3dSample().bytes()), map);
    EXPECT_EQ(recordings[0].points[1].name, "b");
    EXPECT_DOUBLE_EQ(recordings[0].points[1].at(0, 0), 10);
    EXPECT_DOUBLE_EQ(recordings[0].times[2], 0.04);
    EXPECT_DOUBLE_EQ(recordings[1].times[1], 0.01);
}

TEST(C3dFile, SaysWhereItIsBroken) {
    const TemporaryFolder folder;
    const auto refusal = [&](const std::string& bytes, const FileMap& map = {}) {
        return message_of([&] { read_recordings(folder.write("run.c3d", bytes), map); });
    };
    const std::string sound = C3dSample().bytes();
    EXPECT_TRUE(says(refusal(sound.substr(0, sound.size() - 512)), {"run.c3d", "announces 3 frames", "cut off"}));
    EXPECT_TRUE(says(refusal(sound.substr(0, 700)), {"run.c3d", "cut off"}));
    std::string processor = sound;
    processor[515] = 99;
    EXPECT_TRUE(says(refusal(processor), {"processor is 99", "84 (Intel)"}));
    std::string analogs = sound;
    analogs[4] = 3;
    EXPECT_TRUE(says(refusal(analogs), {"3 analog numbers a frame", "2 channels"}));
    C3dSample furlongs;
    furlongs.unit = "fur";
    EXPECT_TRUE(says(refusal(furlongs.bytes()), {"'fur' is no unit of length", "unit: mm"}));
    FileMap names;
    names.names = {"one"};
    EXPECT_TRUE(says(refusal(sound, names), {"1 names", "2 points"}));
}

}  // namespace
}  // namespace palpate::identify
