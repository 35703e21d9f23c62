#include "tests/identify/recordings/exodus_sample.h"

#include <gtest/gtest.h>

#include "tests/identify/recordings/read_sample.h"

namespace palpate::identify {
namespace {

Recording read_exodus_sample(const ExodusSample& sample, const FileMap& map = {}) {
    const TemporaryFolder folder;
    return read_recordings(write_exodus(folder / "dic.e", sample), map).at(0);
}

TEST(Exodus, NodesMoveFromRest) {
    const Recording run = read_exodus_sample({});
    EXPECT_EQ(run.format, "Exodus, DICe, image correlation");
    ASSERT_EQ(run.points.size(), 2u);
    EXPECT_EQ(run.points[1].name, "2");
    EXPECT_EQ(run.points[0].at.col(0), Eigen::Vector3d(1.5, 2, 3));
    EXPECT_EQ(run.points[0].at.col(1), Eigen::Vector3d(2, 2, 3.25));
    EXPECT_EQ(run.points[1].displacement.col(0), Eigen::Vector3d(0.5, 0, 0));
    EXPECT_TRUE(run.points[1].at.col(1).array().isNaN().all());
    EXPECT_TRUE(notes_tell(run, "negative sigma"));
    EXPECT_FALSE(run.has_clock);  // 1 and 2 count frames
}

TEST(Exodus, OneCameraSeesPixels) {
    FileMap map;
    map.unit = "pixel";
    map.pixel = 0.1;
    map.rate = 10;
    const ExodusSample sample{.dimensions = 2, .displacement = "DISPLACEMENT_"};
    const Recording run = read_exodus_sample(sample, map);
    EXPECT_TRUE(run.points[0].at.col(0).isApprox(Eigen::Vector3d(0.15, 0.2, 0)));
    EXPECT_EQ(run.times, Eigen::Vector2d(0, 0.1));
    EXPECT_TRUE(notes_tell(read_exodus_sample(sample), "pixels"));
}

TEST(Exodus, OtherProgramsHaveNamesTimesAndIds) {
    const Recording run = read_exodus_sample(
        {.times = {0.25, 0.5}, .displacement = "disp_", .has_sigma = false, .is_one_variable = true, .has_ids = true});
    EXPECT_EQ(run.format, "Exodus, nodes");
    EXPECT_TRUE(run.has_clock);
    EXPECT_EQ(run.times, Eigen::Vector2d(0.25, 0.5));
    EXPECT_EQ(run.points[1].name, "18");
    EXPECT_EQ(run.points[1].at.col(1), Eigen::Vector3d(5, 5, 6.25));
}

TEST(Exodus, SaysWhatItLacks) {
    const TemporaryFolder folder;
    const auto refusal = [&](const ExodusSample& sample) {
        return message_of([&] { read_recordings(write_exodus(folder / "dic.e", sample)); });
    };
    EXPECT_TRUE(says(refusal({.displacement = "VELOCITY_"}), {"dic.e", "VELOCITY_X", "DISPLACEMENT_X"}));
    EXPECT_TRUE(says(refusal({.times = {2, 1}}), {"dic.e", "do not ascend"}));
    const auto cut = [&](const char* name, const std::string& bytes) {
        return message_of([&] { read_recordings(folder.write(name, bytes)); });
    };
    EXPECT_TRUE(says(cut("a.e", std::string("CDF\x02") + "cut"), {"a.e", "no whole Exodus"}));
    EXPECT_TRUE(says(cut("b.h5", "\x89HDF\r\n\x1a\n"), {"b.h5", "no whole Exodus"}));
}

}  // namespace
}  // namespace palpate::identify
