// Files of rigs of public projects, as their laboratories wrote them.

#include <gtest/gtest.h>

#include <cstdlib>

#include "identify/recordings/files/read_recordings.h"

namespace palpate::identify {
namespace {

namespace fs = std::filesystem;

class Rigs : public testing::Test {
protected:
    void SetUp() override {
        const char* data = std::getenv("PALPATE_DATA");
        if (!data || !fs::exists(fs::path(data) / "rigs")) GTEST_SKIP() << "PALPATE_DATA names no folder with rigs";
        folder_ = fs::path(data) / "rigs";
    }
    fs::path folder_;
};

TEST_F(Rigs, PneumaticArmIsAC3dFileInMetres) {
    for (const char* pressure : {"100mbar", "200mbar", "300mbar", "400mbar"}) {
        const auto recordings = read_recordings(folder_ / "pneumatic-arm" / (std::string(pressure) + ".c3d"));
        ASSERT_EQ(recordings.size(), 1u);
        const Recording& run = recordings[0];
        EXPECT_TRUE(run.points.size() == 7 || run.points.size() == 8);
        EXPECT_TRUE(run.has_clock);
        // Markers of the clamp: 44 mm apart by the authors' targets; they stood within a millimetre of that.
        const auto marker = [&](const std::string& name) {
            for (const RecordedPoint& point : run.points)
                if (point.name == name) return Eigen::Vector3d(point.at.col(0));
            return Eigen::Vector3d(Eigen::Vector3d::Zero());
        };
        EXPECT_NEAR((marker("Base - 1") - marker("Base - 4")).norm(), 44.0, 1) << pressure;
    }
}

TEST_F(Rigs, TentacleHasFiveMarkersAtTwoHundredHertz) {
    FileMap map;
    map.unit = "m";
    map.names = {"1", "3", "4", "2", "base"};
    const Recording run = read_recordings(folder_ / "tentacle/m1_u01.csv", map)[0];
    ASSERT_EQ(run.points.size(), 5u);
    EXPECT_EQ(run.points[4].name, "base");
    ASSERT_EQ(run.times.size(), 1160);
    EXPECT_DOUBLE_EQ(run.times[1159], 5.795);
    EXPECT_DOUBLE_EQ(run.points[0].at(0, 0), 217.511);
}

TEST_F(Rigs, SkinIsSheetsOfPixels) {
    FileMap map;
    map.unit = "pixel";
    map.pixel = 0.1;
    map.sheets = MappedSheets{{"xt.dat", "yt.dat"}, {"x0.dat", "y0.dat"}, false};
    const Recording run = read_recordings(folder_ / "skin/xt.dat", map)[0];
    ASSERT_EQ(run.points.size(), 544u);
    ASSERT_EQ(run.times.size(), 50);  // 49 and the one at rest
    EXPECT_DOUBLE_EQ(run.points[0].at(0, 0), 41.9);
    EXPECT_DOUBLE_EQ(run.points[0].at(0, 1), 41.91);

    FileMap pad;
    pad.rate = 10;
    pad.channels = {{{"1", ""}, "u", "mm"}, {{"1", "f_moving_pad.dat"}, "F", "N"}};
    const Recording log = read_recordings(folder_ / "skin/u_moving_pad.dat", pad)[0];
    ASSERT_EQ(log.channels.size(), 2u);
    EXPECT_DOUBLE_EQ(log.channels[0].values.maxCoeff(), 8.7);
    EXPECT_EQ(log.channels[1].unit, "N");
    EXPECT_EQ(log.channels[0].values.size(), log.channels[1].values.size());
}

}  // namespace
}  // namespace palpate::identify
