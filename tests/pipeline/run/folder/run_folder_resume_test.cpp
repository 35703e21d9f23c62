// A run that is killed and started again ends as one that ran through.

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <random>

#include "mesh/formats/surface/read_surface.h"
#include "mesh/text/atomic_file.h"
#include "mesh/text/unfinished.h"
#include "pipeline/run/folder/run_folder.h"
#include "tests/messages.h"
#include "tests/places.h"
#include "tests/sanitizers.h"
#include "tests/temporary_folder.h"
#include "tests/wait.h"

namespace palpate::pipeline {
namespace {

namespace fs = std::filesystem;

/// What the system grants a process: a resource of `setrlimit` and how much of it.
struct Grant {
    __rlimit_resource resource;
    rlim_t most;
};

/// In the names of the tests.
void PrintTo(const Grant& grant, std::ostream* out) {
    *out << (grant.resource == RLIMIT_AS ? "address space " : "files ") << grant.most;
}

/// `palpate run beam.stl -o run` as a process of its own; what it says goes to `said`.
pid_t start_run(const TemporaryFolder& scratch, const std::string& output, std::optional<Grant> grant = {}) {
    const pid_t child = fork();
    if (child != 0) return child;
    const std::string input = scratch / "beam.stl", folder = scratch / output, said = scratch / "said";
    if (!freopen("/dev/null", "w", stdout) || !freopen(said.c_str(), "w", stderr)) _exit(127);
    if (grant) {
        const rlimit limit{grant->most, grant->most};
        if (setrlimit(grant->resource, &limit) != 0) _exit(127);
    }
    execl(program_file, "palpate", "run", input.c_str(), "-o", folder.c_str(), "--spheres", "8", "--particles", "40",
          "--parameters", "uniform", "--threads", "1", nullptr);
    _exit(127);
}

int finish(pid_t child) {
    int status = 0;
    waitpid(child, &status, 0);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

/// All that a run leaves, but for what tells seconds and memory.
std::vector<std::string> files_of(const fs::path& run) {
    std::vector<std::string> files;
    for (const auto& entry : fs::recursive_directory_iterator(run)) {
        const std::string name = fs::relative(entry.path(), run).string();
        if (entry.is_regular_file() && name != "run.json" && name != "report.html") files.push_back(name);
    }
    std::ranges::sort(files);
    return files;
}

/// More kills than in the suite: PALPATE_KILLS=50.
int kills() {
    const char* asked = std::getenv("PALPATE_KILLS");
    return asked != nullptr ? std::atoi(asked) : 5;
}

/// How many files there are at the moment, finished or not, in a folder that somebody else writes to.
std::size_t files_now(const fs::path& folder) {
    std::error_code error;
    std::size_t files = 0;
    for (auto it = fs::recursive_directory_iterator(folder, error); !error && it != fs::end(it); it.increment(error))
        ++files;
    return files;
}

bool has_ended(pid_t child) {
    siginfo_t info{};
    return waitid(P_PID, static_cast<id_t>(child), &info, WEXITED | WNOHANG | WNOWAIT) == 0 && info.si_pid == child;
}

/// Waits until the child has added so many files to the folder, or has ended.
void wait_for_files(pid_t child, const fs::path& folder, std::size_t files) {
    const std::size_t before = files_now(folder);
    EXPECT_TRUE(comes_true([&] { return has_ended(child) || files_now(folder) >= before + files; }));
}

TEST(Resume, AKilledRunEndsAsOneThatRanThrough) {
    const TemporaryFolder scratch;
    mesh::write_surface(scratch / "beam.stl", mesh::make_box({0, 0, 0}, {100, 20, 20}, {10, 2, 2}));
    ASSERT_EQ(finish(start_run(scratch, "whole")), 0);
    const std::vector<std::string> files = files_of(scratch / "whole");

    std::mt19937 random(1);
    int killed = 0;
    for (int i = 0; i < kills(); ++i) {
        if (i % 5 == 0) fs::remove_all(scratch / "run");  // else every later kill would find all stages finished
        const pid_t child = start_run(scratch, "run");
        // Five kills share out a run's files among them.
        wait_for_files(child, scratch / "run", std::uniform_int_distribution<std::size_t>(0, files.size() / 3)(random));
        kill(child, SIGKILL);
        killed += finish(child) == -1 ? 1 : 0;
        if (i % 5 < 4 && i + 1 < kills()) continue;

        ASSERT_EQ(finish(start_run(scratch, "run")), 0) << mesh::read_text(scratch / "said");
        EXPECT_EQ(files_of(scratch / "run"), files);
        for (const std::string& file : files) {
            EXPECT_EQ(sha256_of_file(scratch / "run" / file), sha256_of_file(scratch / "whole" / file)) << file;
        }
    }
    EXPECT_GT(killed, 0);  // the first one is: it waits for less than a run leaves
}

/// A run that is granted too little ends with a message, leaves no half of a file, and goes on to the same end when it
/// is granted more.
class ShortOf : public testing::TestWithParam<std::tuple<Grant, std::string>> {};

TEST_P(ShortOf, SaysSoAndGoesOnLater) {
    const auto& [grant, message] = GetParam();
    const TemporaryFolder scratch;
    mesh::write_surface(scratch / "beam.stl", mesh::make_box({0, 0, 0}, {100, 20, 20}, {10, 2, 2}));
    ASSERT_EQ(finish(start_run(scratch, "whole")), 0);

    const int code = finish(start_run(scratch, "run", grant));
    EXPECT_TRUE(code == 3 || code == 4) << code;
    EXPECT_TRUE(says(mesh::read_text(scratch / "said"), {"error: ", message.c_str()}))
        << mesh::read_text(scratch / "said");
    const std::vector<std::string> whole = files_of(scratch / "whole");
    if (fs::exists(scratch / "run")) {
        for (const std::string& file : files_of(scratch / "run")) {
            if (file == ".lock") continue;
            EXPECT_EQ(sha256_of_file(scratch / "run" / file), sha256_of_file(scratch / "whole" / file)) << file;
        }
    }
    ASSERT_EQ(finish(start_run(scratch, "run")), 0) << mesh::read_text(scratch / "said");
    EXPECT_EQ(files_of(scratch / "run"), whole);
}

std::vector<std::tuple<Grant, std::string>> too_little() {
    constexpr rlim_t kB = 1000;
    std::vector<std::tuple<Grant, std::string>> grants = {{{RLIMIT_FSIZE, 4 * kB}, "cannot be written"},
                                                          {{RLIMIT_FSIZE, 60 * kB}, "cannot be written"}};
#ifndef PALPATE_ADDRESS_SANITIZER  // which addresses terabytes itself
    grants.push_back({{RLIMIT_AS, 500'000 * kB}, "address space is limited to 500 MB"});
#endif
    return grants;
}
INSTANTIATE_TEST_SUITE_P(Resume, ShortOf, testing::ValuesIn(too_little()));

TEST(Resume, ASecondRunInOneFolderSaysSoAndStops) {
    const TemporaryFolder scratch;
    {
        const RunFolder first(scratch / "run", false);
        EXPECT_TRUE(
            says(message_of([&] { const RunFolder second(scratch / "run", false); }), {"another palpate works", "-o"}));
    }
    EXPECT_NO_THROW(const RunFolder third(scratch / "run", false));
}

TEST(Resume, AFolderThatAKilledRunHadJustBegunIsItsOwn) {
    const TemporaryFolder scratch;
    mesh::write_text(scratch / "run/.lock", "");
    mesh::write_text(mesh::unfinished_beside(scratch / "run/run.json"), "{");
    EXPECT_NO_THROW(const RunFolder again(scratch / "run", false));
    mesh::write_text(scratch / "other/.lock", "");
    mesh::write_text(scratch / "other/letter.txt", "");
    EXPECT_TRUE(
        says(message_of([&] { const RunFolder other(scratch / "other", false); }), {"did not make", "--force"}));
}

TEST(Resume, WhatAKilledRunLeftHalfWrittenGoes) {
    const TemporaryFolder scratch;
    { const RunFolder first(scratch / "run", false); }
    const fs::path remains = mesh::unfinished_beside(scratch / "run/model.json");
    mesh::write_text(remains, "{");
    fs::create_directories(mesh::unfinished_beside(scratch / "run/measurements"));
    const RunFolder again(scratch / "run", false);
    EXPECT_FALSE(fs::exists(remains));
    EXPECT_EQ(files_of(scratch / "run"), std::vector<std::string>{".lock"});
}

}  // namespace
}  // namespace palpate::pipeline
