// Readings that come while the program runs: rows that another program appends, lines of JSON, clouds on disk.

#include "pipeline/live/follow.h"

#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <array>
#include <fstream>
#include <nlohmann/json.hpp>
#include <stop_token>
#include <thread>

#include "skeleton/model/io/model_io.h"
#include "tests/pipeline/live/followed_rig.h"
#include "tests/wait.h"

namespace palpate::pipeline {
namespace {

namespace fs = std::filesystem;
using identify::LoadState;

/// Without what the log says.
std::vector<nlohmann::json> lines_of(const std::string& text) {
    std::vector<nlohmann::json> lines;
    std::istringstream in(text);
    for (std::string line; std::getline(in, line);) {
        if (line.starts_with("{")) lines.push_back(nlohmann::json::parse(line));
    }
    return lines;
}

TEST(Follow, TakesInRowsThatAreAppendedAndGoesOnWhereItWasKilled) {
    const FollowedRig rig;
    testing::internal::CaptureStdout();
    {
        const std::jthread other([&](const std::stop_token& gone) {
            rig.wait_until_followed(gone);
            rig.append(6, 9);
        });
        commands::follow(rig.options("live"), {true, false, 1, {}});
    }
    const std::vector<nlohmann::json> first = lines_of(testing::internal::GetCapturedStdout());
    ASSERT_EQ(first.size(), 3);
    for (const nlohmann::json& line : first) {
        EXPECT_EQ(line["fate"], "taken in");
        EXPECT_GT(line["p_value"], 1e-4);
        EXPECT_TRUE(line["alarm"].is_null());
        EXPECT_NEAR(line["posterior"]["elongation"]["mean"], 1.5, 0.15);  // of a percent or two each
    }
    EXPECT_TRUE(fs::exists(rig.folder / "live/posterior.csv"));
    EXPECT_TRUE(fs::exists(rig.folder / "live/particles.csv"));

    // again: it knows what it has seen, and nothing twice
    rig.append(9, 12);
    testing::internal::CaptureStdout();
    commands::follow(rig.options("live"), {true, false, 1, {}});
    const std::vector<nlohmann::json> second = lines_of(testing::internal::GetCapturedStdout());
    ASSERT_EQ(second.size(), 3);
    EXPECT_EQ(second.back()["readings"], 12);
    const skeleton::Model fitted = skeleton::read_model(rig.folder / "live/model.json");
    EXPECT_NEAR(fitted.links.front().stiffness[0], 1.5, 0.1);
}

TEST(Follow, TellsRowsThatNoReaderTakes) {
    const FollowedRig rig;
    testing::internal::CaptureStdout();
    {
        const std::jthread other([&](const std::stop_token& gone) {
            rig.wait_until_followed(gone);
            const std::string label = identify::label_of(rig.set.markers.front());
            std::ofstream(rig.folder / "set/probes.csv", std::ios::app) << "77,1,0,0,0,1,0,0,0\n78,1,0,0,90,1,0,0,0\n";
            std::ofstream(rig.folder / "set/positions.csv", std::ios::app)
                << "77,1,none,1,2,3,\n78,1," << label << ",1,2,3,\n";
            rig.append(6, 7);
        });
        commands::follow(rig.options("live"), {});
    }
    const std::string text = testing::internal::GetCapturedStdout();
    EXPECT_NE(text.find("left out: among the rows '77,1,none"), std::string::npos) << text;
    EXPECT_NE(text.find("left out: probes.csv: the contact of probe 78 at time 1 at [0, 0, 90] mm lies"),
              std::string::npos)
        << text;
    EXPECT_NE(text.find("taken in; forecast off by"), std::string::npos) << text;
}

/// As a program sends it.
std::string json_line(const identify::MeasurementSet& set, const LoadState& state) {
    nlohmann::json line = {{"probe", state.probe}, {"time", state.time}};
    for (const mesh::Contact& contact : state.contacts)
        line["contacts"].push_back({{"at", {contact.point.x(), contact.point.y(), contact.point.z()}},
                                    {"force", {contact.force.x(), contact.force.y(), contact.force.z()}}});
    for (const identify::Reading& reading : state.readings)
        line["markers"][identify::label_of(set.markers[reading.marker])] = {reading.position.x(), reading.position.y(),
                                                                            reading.position.z()};
    return line.dump() + "\n";
}

/// Sends text to a socket, ends, and returns what is answered.
std::string answer_to(const std::string& text, const fs::path& path) {
    const int client = ::socket(AF_UNIX, SOCK_STREAM, 0);
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    path.string().copy(address.sun_path, sizeof(address.sun_path) - 1);
    EXPECT_EQ(::connect(client, reinterpret_cast<const sockaddr*>(&address), sizeof(address)), 0);
    EXPECT_EQ(::send(client, text.data(), text.size(), 0), static_cast<ssize_t>(text.size()));
    ::shutdown(client, SHUT_WR);
    std::string answer;
    std::array<char, 4096> bytes{};
    for (ssize_t count = 0; (count = ::read(client, bytes.data(), bytes.size())) > 0;)
        answer.append(bytes.data(), static_cast<std::size_t>(count));
    ::close(client);
    return answer;
}

TEST(Follow, AnswersTheProgramsThatConnectToItsSocket) {
    const FollowedRig rig;
    commands::FollowOptions options = rig.options("live");
    options.socket = rig.folder / "rig.sock";
    options.set = rig.folder / "set";
    std::vector<nlohmann::json> first, second;
    {
        const std::jthread other([&](const std::stop_token& gone) {
            comes_true([&] { return fs::exists(options.socket) || gone.stop_requested(); });
            first = lines_of(answer_to(json_line(rig.set, rig.set.states[6]) + json_line(rig.set, rig.set.states[7]),
                                       options.socket));
            second = lines_of(answer_to("no JSON\n" + json_line(rig.set, rig.set.states[8]), options.socket));
        });
        testing::internal::CaptureStdout();
        commands::follow(options, {});
        testing::internal::GetCapturedStdout();
    }
    ASSERT_EQ(first.size(), 2u);
    EXPECT_EQ(first[1]["probe"], rig.set.states[7].probe);
    EXPECT_EQ(first[1]["fate"], "taken in");
    ASSERT_EQ(second.size(), 2u);
    EXPECT_EQ(second[0]["fate"], "left out");
    EXPECT_NE(second[0]["why"].get<std::string>().find("rig.sock, line 3"), std::string::npos) << second[0];
    EXPECT_EQ(second[1]["readings"], 9);
    EXPECT_FALSE(fs::exists(options.socket)) << "it is removed in the end";
}

}  // namespace
}  // namespace palpate::pipeline
