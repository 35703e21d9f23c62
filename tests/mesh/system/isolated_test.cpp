// What comes back from work in a process of its own: its result, its errors in words, and how it ended else.

#include "mesh/system/isolated.h"

#include <gtest/gtest.h>

#include <csignal>
#include <thread>

#include "mesh/errors.h"
#include "mesh/topology/check_surface.h"
#include "tests/messages.h"

namespace palpate::mesh {
namespace {

using namespace std::chrono_literals;

std::string run(const ChildLimits& limits, const std::function<std::string()>& work) {
    return isolated("The test", "Do less.", limits, work);
}

TEST(Isolated, ReturnsWhatTheWorkDid) {
    EXPECT_EQ(run({}, [] { return std::string("done\0 and more", 14); }), std::string("done\0 and more", 14));
}

TEST(Isolated, ErrorsKeepTheirKindAndWords) {
    EXPECT_EQ(message_of<InvalidInput>([] { run({}, []() -> std::string { throw InvalidInput("line 3"); }); }),
              "line 3");
    EXPECT_EQ(message_of<IoError>([] { run({}, []() -> std::string { throw IoError("no file"); }); }), "no file");
    EXPECT_EQ(message_of<SolverFailure>([] { run({}, []() -> std::string { throw SolverFailure("stuck"); }); }),
              "stuck");
    EXPECT_THROW(run({}, []() -> std::string { throw LimitReached("late"); }), LimitReached);
}

TEST(Isolated, ACrashIsAFailure) {
    EXPECT_TRUE(says(message_of<SolverFailure>([] {
                         run({}, []() -> std::string {
                             raise(SIGKILL);
                             return "";
                         });
                     }),
                     {"The test broke off", "signal 9", "Do less."}));
}

TEST(Isolated, LimitsAreTold) {
    EXPECT_TRUE(says(message_of<LimitReached>([] {
                         run({.seconds = 0.05}, [] {
                             std::this_thread::sleep_for(60s);
                             return std::string();
                         });
                     }),
                     {"did not end within 0.05 s", "Do less."}));
}

TEST(Isolated, WorksAtOnceWithinAChild) {
    const std::string answer = run({}, [] {
        const pid_t child = getpid();
        return run({}, [&] { return std::string(getpid() == child ? "same" : "another"); });
    });
    EXPECT_EQ(answer, "same");
}

TEST(Isolated, AChildMayBeginOthers) {
    const std::string answer = run(
        {.seconds = 60}, [] { return run_in_child([] { return std::string("from below"); }, {.seconds = 30}).answer; });
    EXPECT_EQ(answer, "from below");
}

}  // namespace
}  // namespace palpate::mesh
