#pragma once

#include <functional>
#include <string>

namespace palpate::mesh {

struct ChildLimits {
    double seconds = 60;      // of processor time, and four times as many of wall time, as others may use the machine
    double mebibytes = 8192;  // of memory, on top of what this process holds
    double rest = 5;          // [s] of a child that does nothing, until another is begun; a choice, work sleeps less
};

/// How a child process ended.
struct ChildResult {
    enum class End { Answered, Crashed, OutOfTime, OutOfMemory, Failed };
    End end = End::Failed;
    int signal = 0;      // that ended it, when it crashed
    int code = 0;        // exit code, when it failed
    std::string answer;  // what `work` returned, when it answered
};

/// Is this process a child that run_in_child() began?
bool is_child_process();

/// Runs `work` in a child process with limits; its crash, hang or greed does no harm here. The child prints
/// nothing, holds no file of this process open, and ends with it. It begins as a copy of this thread alone: `work` must
/// not wait for other threads. A lock of a library that another thread held at that moment stays locked in the copy; a
/// copy that comes to rest is therefore ended, and `work` begun once more in another.
/// @throws SolverFailure when no child can be started.
ChildResult run_in_child(const std::function<std::string()>& work, const ChildLimits& limits);

}  // namespace palpate::mesh
