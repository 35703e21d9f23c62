#include <gtest/gtest.h>

#include "tests/identify/recordings/read_sample.h"
#include "tests/temporary_folder.h"

namespace palpate::identify {
namespace {

TEST(Sheets, AreMatricesOfCoordinates) {
    const TemporaryFolder folder;
    folder.write("x0.dat", " 1.0\n 2.0\n");
    folder.write("y0.dat", " 3.0\n 4.0\n");
    folder.write("xt.dat", " 1.1\t 1.2\t 1.3\t\n 2.1\t 2.2\t nan\t\n");
    folder.write("yt.dat", " 3.1\t 3.2\t 3.3\t\n 4.1\t 4.2\t 4.3\t\n");
    FileMap map;
    map.unit = "pixel";
    map.pixel = 0.5;
    map.sheets = MappedSheets{{"xt.dat", "yt.dat"}, {"x0.dat", "y0.dat"}, false};
    const auto run = read_recordings(folder / "xt.dat", map)[0];
    ASSERT_EQ(run.points.size(), 2u);
    ASSERT_EQ(run.times.size(), 4);
    EXPECT_TRUE(run.points[0].at.col(0).isApprox(Eigen::Vector3d(0.5, 1.5, 0)));
    EXPECT_TRUE(run.points[1].at.col(2).isApprox(Eigen::Vector3d(1.1, 2.1, 0)));
    EXPECT_TRUE(run.points[1].at.col(3).array().isNaN().all());
    EXPECT_FALSE(run.has_clock);

    map.sheets->frames_in_rows = true;
    EXPECT_TRUE(says(message_of([&] { read_recordings(folder / "xt.dat", map); }), {"3 points", "frames_in"}));
    folder.write("yt.dat", " 3.1 3.2\n 4.1 4.2\n");
    map.sheets->frames_in_rows = false;
    EXPECT_TRUE(
        says(message_of([&] { read_recordings(folder / "xt.dat", map); }), {"yt.dat holds 2 points and 2 frames"}));
    map.sheets->at = {"xt.dat", "zt.dat"};
    EXPECT_TRUE(says(message_of<IoError>([&] { read_recordings(folder / "xt.dat", map); }), {"zt.dat"}));
}

}  // namespace
}  // namespace palpate::identify
