#include "pipeline/live/cloud_file.h"

#include <gtest/gtest.h>

#include "identify/numerics/random.h"
#include "mesh/errors.h"
#include "tests/messages.h"
#include "tests/temporary_folder.h"

namespace palpate::pipeline {
namespace {

TEST(CloudFile, HoldsAllThatAFilterKnows) {
    const TemporaryFolder folder;
    Cloud cloud;
    cloud.begun_with = 4;
    cloud.state.v = identify::RandomStream(1, 0, 0).normals(5);
    cloud.state.spectrum = {Eigen::VectorXd::LinSpaced(2, 3, 1), Eigen::MatrixXd::Random(5, 2)};
    cloud.state.readings = 9;
    cloud.state.seen = {{1, 0}, {2, 0.5}};
    cloud.state.change.sum = 4.25;
    cloud.state.change.since = identify::StateName{2, 0.5};
    cloud.state.change.off = Eigen::VectorXd::LinSpaced(3, 0, 1);
    cloud.state.change.count = 2;
    write_cloud(folder / "cloud.json", cloud);
    const Cloud read = read_cloud(folder / "cloud.json");
    EXPECT_EQ(read.begun_with, 4);
    EXPECT_EQ(read.state.v, cloud.state.v);
    EXPECT_EQ(read.state.spectrum.values, cloud.state.spectrum.values);
    EXPECT_EQ(read.state.spectrum.vectors, cloud.state.spectrum.vectors);
    EXPECT_EQ(read.state.seen, cloud.state.seen);
    EXPECT_EQ(read.state.change.since, cloud.state.change.since);
    EXPECT_EQ(read.state.change.off, cloud.state.change.off);

    for (const char* text : {"", "{}", R"({"format": "palpate-model/1"})"}) {
        folder.write("cloud.json", text);
        EXPECT_NE(message_of([&] { read_cloud(folder / "cloud.json"); }).find("remove it to begin anew"),
                  std::string::npos);
    }
    EXPECT_NE(message_of<IoError>([&] { read_cloud(folder / "none.json"); }), "");
}

}  // namespace
}  // namespace palpate::pipeline
