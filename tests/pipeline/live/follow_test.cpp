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

#include "identify/numerics/random.h"
#include "mesh/text/atomic_file.h"
#include "pipeline/live/cloud_file.h"
#include "pipeline/live/json_lines.h"
#include "pipeline/live/json_reading.h"
#include "pipeline/live/set_tail.h"
#include "skeleton/model/io/model_io.h"
#include "tests/identify/lattice.h"
#include "tests/messages.h"
#include "tests/temporary_folder.h"
#include "tests/wait.h"

namespace palpate::pipeline {
namespace {

namespace fs = std::filesystem;
using identify::LoadState;

/// A small lattice in a box, its set on disk, and rows that are still to come.
struct Rig {
    TemporaryFolder folder;
    skeleton::Model model = identify::make_lattice({3, 2, 1});
    identify::MeasurementSet set;

    Rig() {
        model.surface = mesh::make_box(Vec3(0, -20, -3), Vec3(80, 60, 3), {4, 4, 1});
        model.supports = {mesh::BoxRegion{Vec3(-1, -21, -4), Vec3(1, 61, 4)}};
        std::vector<Vec3> forces;
        for (int i = 0; i < 12; ++i) {
            const Eigen::VectorXd f = identify::RandomStream(5, 0, i).normals(3);
            forces.emplace_back(2 * f[0], 2 * f[1], 0.2 * f[2]);
        }
        set = identify::simulate_measurements(identify::with_truth(model, {1.5}, {600}),
                                              identify::push_spheres(model, forces),
                                              identify::markers_on_spheres(model), 0.05);
        set.name = "stream";
        skeleton::write_model(folder / "model.json", model);
        write(6);
    }
    /// The first states, as a set.
    void write(int count) const {
        identify::MeasurementSet part = set;
        part.states.resize(static_cast<std::size_t>(count));
        identify::write_measurement_set(folder / "set", part);
    }
    /// As a program that appends would: loads first, then positions.
    void append(int from, int to) const {
        identify::MeasurementSet part = set;
        part.states.assign(set.states.begin() + from, set.states.begin() + to);
        const TemporaryFolder other;
        identify::write_measurement_set(other / "set", part);
        for (const char* table : {"probes.csv", "positions.csv"}) {
            const std::string text = mesh::read_text(other / "set" / table);
            std::ofstream(folder / "set" / table, std::ios::app)
                << text.substr(text.find("\n", text.find("probe")) + 1);
        }
    }
    /// By "live", which has then read what is there.
    void wait_until_followed(const std::stop_token& gone) const {
        comes_true([&] { return fs::exists(folder / "live/cloud.json") || gone.stop_requested(); });
    }
    commands::FollowOptions options(const char* output) const {
        commands::FollowOptions how{folder / "model.json", folder / "set", folder / output, false, 2, {}, {}};
        how.how.scope = identify::Scope::uniform;
        how.how.law = identify::LawChoice::large_rotation;
        how.how.fixed = {skeleton::Stiffness::torsion};
        return how;
    }
};

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
    const Rig rig;
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
    const Rig rig;
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
    const Rig rig;
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

TEST(UnixSocket, StandsInForOneThatWasLeftAndForNothingElse) {
    const TemporaryFolder folder;
    mesh::write_text(folder / "table.csv", "1\n");
    EXPECT_NE(message_of([&] { unix_socket(folder / "table.csv"); }).find("is no socket"), std::string::npos);
    EXPECT_NE(message_of([&] { unix_socket(folder / std::string(200, 'a')); }).find("shorter"), std::string::npos);
    EXPECT_NE(message_of<IoError>([&] { unix_socket(folder / "none/rig.sock"); }).find("none/rig.sock"),
              std::string::npos);
    {
        const auto listening = unix_socket(folder / "rig.sock");
        EXPECT_NE(message_of([&] { unix_socket(folder / "rig.sock"); }).find("another program listens"),
                  std::string::npos);
    }
    {  // as a program leaves it that is killed
        const int left = ::socket(AF_UNIX, SOCK_STREAM, 0);
        sockaddr_un address{};
        address.sun_family = AF_UNIX;
        (folder / "rig.sock").string().copy(address.sun_path, sizeof(address.sun_path) - 1);
        ASSERT_EQ(::bind(left, reinterpret_cast<const sockaddr*>(&address), sizeof(address)), 0);
        ::close(left);
    }
    EXPECT_NO_THROW(unix_socket(folder / "rig.sock"));
}

/// The next states, so many at least, as they become whole.
std::vector<LoadState> next_states(SetTail& tail, std::size_t count) {
    std::vector<LoadState> states;
    EXPECT_TRUE(comes_true([&] {
        const SetTail::News news = tail.poll();
        states.insert(states.end(), news.states.begin(), news.states.end());
        return states.size() >= count;
    }));
    return states;
}

TEST(SetTail, GivesEachStateOnceAndWhole) {
    const Rig rig;
    SetTail tail(rig.folder / "set");
    EXPECT_EQ(tail.poll().states.size(), 5);  // the last one may go on
    EXPECT_EQ(next_states(tail, 1).size(), 1);
    EXPECT_EQ(tail.poll().states.size(), 0);
    // half a row is none
    std::ofstream(rig.folder / "set/positions.csv", std::ios::app) << "8,1,";
    EXPECT_EQ(tail.poll().states.size(), 0);
    fs::remove(rig.folder / "set/positions.csv");
    EXPECT_NE(message_of<IoError>([&] { tail.poll(); }).find("positions.csv"), std::string::npos);
}

TEST(SetTail, ReadsWhatTheSetsReaderReads) {
    const Rig rig;
    SetTail tail(rig.folder / "set");
    tail.poll();
    rig.append(6, 8);
    const std::vector<LoadState> states = next_states(tail, 3);
    ASSERT_EQ(states.size(), 3);
    const identify::MeasurementSet whole = identify::read_measurement_set(rig.folder / "set");
    for (std::size_t i = 0; i < 3; ++i) {
        const LoadState& expected = whole.states[5 + i];
        ASSERT_EQ(states[i].probe, expected.probe);
        ASSERT_EQ(states[i].readings.size(), expected.readings.size());
        EXPECT_EQ(states[i].contacts.front().force, expected.contacts.front().force);
        for (std::size_t r = 0; r < expected.readings.size(); ++r) {
            EXPECT_EQ(states[i].readings[r].position, expected.readings[r].position);
        }
    }
}

TEST(JsonReading, SaysWhatALineHolds) {
    const Rig rig;
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
