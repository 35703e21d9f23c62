// What a child process does, and what is seen of it, however it ends.

#include "mesh/system/child_process.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <filesystem>
#include <latch>
#include <mutex>
#include <stdexcept>
#include <string>
#include <thread>

#include "mesh/text/atomic_file.h"
#include "tests/sanitizers.h"
#include "tests/temporary_folder.h"
#include "tests/wait.h"

namespace palpate::mesh {
namespace {

using namespace std::chrono_literals;
using End = ChildResult::End;

TEST(ChildProcess, Answers) {
    const std::string long_answer(3'000'000, 'x');  // more than a pipe holds
    const ChildResult result = run_in_child([&] { return long_answer; }, {});
    EXPECT_EQ(result.end, End::Answered);
    EXPECT_EQ(result.answer, long_answer);
}

TEST(ChildProcess, TellsTheSignalThatEndedIt) {
    const ChildResult result = run_in_child(
        []() -> std::string {
            raise(SIGKILL);
            return "";
        },
        {});
    EXPECT_EQ(result.end, End::Crashed);
    EXPECT_EQ(result.signal, SIGKILL);
}

TEST(ChildProcess, ThrowingIsFailing) {
    EXPECT_EQ(run_in_child([]() -> std::string { throw std::runtime_error("no"); }, {}).end, End::Failed);
}

TEST(ChildProcess, LeavingHalfwayIsFailing) {
    const ChildResult result = run_in_child([]() -> std::string { _exit(5); }, {});
    EXPECT_EQ(result.end, End::Failed);
    EXPECT_EQ(result.code, 5);
}

TEST(ChildProcess, EndsWithItsTime) {
    const ChildResult result = run_in_child(
        [] {
            std::this_thread::sleep_for(1h);
            return std::string();
        },
        {.seconds = 0.2});
    EXPECT_EQ(result.end, End::OutOfTime);
}

/// A copy begins with every lock as it was, also one that another thread holds: nobody opens it there.
TEST(ChildProcess, IsBegunAgainWhereItWaitsForALockOfAnotherThread) {
    std::mutex mutex;
    std::latch locked(1);
    const TemporaryFolder folder;
    const std::jthread other([&] {  // opens it as soon as the first copy tells that it began
        const std::lock_guard held(mutex);
        locked.count_down();
        comes_true([&] { return std::filesystem::exists(folder / "1"); });
    });
    locked.wait();
    int begun = 0;
    const ChildResult result = run_in_child(
        [&] {
            while (std::filesystem::exists(folder / std::to_string(++begun))) {
            }
            write_text(folder / std::to_string(begun), "");
            const std::lock_guard waiting(mutex);
            return std::to_string(begun);
        },
        {.rest = 0.5});
    EXPECT_EQ(result.end, End::Answered);
    EXPECT_EQ(result.answer, "2");
}

/// What computes is not at rest, nor what waits for a child of its own that does.
TEST(ChildProcess, IsNotBegunAgainWhileItOrItsOwnChildComputes) {
    const TemporaryFolder folder;
    const auto compute = [] {
        const auto end = std::chrono::steady_clock::now() + 1s;
        while (std::chrono::steady_clock::now() < end) {
        }
        return std::string("done");
    };
    const ChildResult result = run_in_child(
        [&] {
            const std::filesystem::path first = folder / "first";
            const std::string before = std::filesystem::exists(first) ? "again " : "";
            write_text(first, "");
            return before + compute() + run_in_child(compute, {.rest = 0.5}).answer;
        },
        {.rest = 0.5});
    EXPECT_EQ(result.answer, "donedone");
}

#ifndef PALPATE_ADDRESS_SANITIZER  // which addresses terabytes itself
TEST(ChildProcess, EndsWithItsMemory) {
    const auto greed = [] { return std::string(std::size_t{512} << 20, 'x'); };
    EXPECT_EQ(run_in_child(greed, {.mebibytes = 64}).end, End::OutOfMemory);
}
#endif

/// A lock on an open file is the child's too: were the parent killed, the file would stay locked.
TEST(ChildProcess, HoldsNoFileOfItsParent) {
    const TemporaryFolder folder;
    const int file = open((folder / "file").c_str(), O_RDWR | O_CREAT, 0644);
    const int late = fcntl(file, F_DUPFD, 200);
    const ChildResult result = run_in_child(
        [&] {
            std::string held;
            for (const int one : {file, late}) held += fcntl(one, F_GETFD) < 0 ? "no" : "yes";
            return held;
        },
        {});
    EXPECT_EQ(result.answer, "nono");
    EXPECT_GE(fcntl(file, F_GETFD), 0);
    close(file);
    close(late);
}

TEST(ChildProcess, EndsWithItsParent) {
    const TemporaryFolder folder;
    const std::string told = folder / "child";
    const pid_t parent = fork();
    ASSERT_GE(parent, 0);
    if (parent == 0) {
        run_in_child(
            [&] {
                write_text(told, std::to_string(getpid()));
                std::this_thread::sleep_for(1h);
                return std::string();
            },
            {});
        _exit(0);
    }
    ASSERT_TRUE(comes_true([&] { return std::filesystem::exists(told); }));
    const auto child = static_cast<pid_t>(std::stol(read_text(told)));
    EXPECT_EQ(kill(child, 0), 0);
    kill(parent, SIGKILL);
    waitpid(parent, nullptr, 0);
    // an orphan that nobody waits for stays as a zombie: it runs no more
    const std::string state = "/proc/" + std::to_string(child) + "/stat";
    EXPECT_TRUE(comes_true([&] {
        return kill(child, 0) != 0 || !std::filesystem::exists(state) ||
               read_text(state).find(") Z") != std::string::npos;
    }));
}

}  // namespace
}  // namespace palpate::mesh
