#include "pipeline/live/json_reading.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/messages.h"
#include "tests/pipeline/live/followed_rig.h"

namespace palpate::pipeline {
namespace {

using identify::LoadState;

TEST(JsonReading, SaysWhatALineHolds) {
    const FollowedRig rig;
    const std::string label = identify::label_of(rig.set.markers[2]);
    const LoadState state = read_json_reading(
        R"({"probe": 3, "time": 1.5, "contacts": [{"at": [1,2,3], "force": [0,0,-1], "radius": 2}], "markers": {")" +
            label + R"(": [4, null, 6]}})",
        rig.set, "line 1");
    EXPECT_EQ(state.probe, 3);
    EXPECT_EQ(state.time, 1.5);
    EXPECT_EQ(state.contacts.front().radius, 2);
    EXPECT_EQ(state.readings.front().marker, 2);
    EXPECT_TRUE(std::isnan(state.readings.front().position.y()));

    const auto refusal = [&](const char* line) {
        return message_of([&] { read_json_reading(line, rig.set, "standard input, line 7"); });
    };
    EXPECT_NE(refusal("probe 3").find("standard input, line 7: 'probe 3' is no JSON"), std::string::npos);
    EXPECT_NE(refusal("[1]").find("no JSON object"), std::string::npos);
    EXPECT_NE(refusal(R"({"time": 0})").find("'probe' is missing"), std::string::npos);
    EXPECT_NE(refusal(R"({"probe": 1.5})").find("no whole number"), std::string::npos);
    EXPECT_NE(refusal(R"({"probe": 1})").find("'markers' is missing"), std::string::npos);
    EXPECT_NE(refusal(R"({"probe": 1, "markers": {"none": [1,2,3]}})").find("'none' is not in markers.csv"),
              std::string::npos);
    EXPECT_NE(refusal(R"({"probe": 1, "contacts": [{"at": [1,2]}], "markers": {}})").find("not three numbers"),
              std::string::npos);
    EXPECT_NE(refusal(R"({"probe": 1, "time": "now", "markers": {}})").find("no number"), std::string::npos);
    EXPECT_NE(refusal(R"({"probe": 1, "markers": 3})").find("no object"), std::string::npos);
}

}  // namespace
}  // namespace palpate::pipeline
