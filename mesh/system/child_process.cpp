#include "mesh/system/child_process.h"

#include <fcntl.h>
#include <fmt/core.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <limits>
#include <mutex>
#include <new>

#include "mesh/errors.h"
#include "mesh/system/interruption.h"
#include "mesh/system/rest.h"

namespace palpate::mesh {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::uint64_t magic = 0x70616c7061746531;  // before the answer, with its size: half an answer is none
constexpr int memory_code = 75;
constexpr int exception_code = 76;

constexpr long long asked_every = 100;  // whether the work is to go on [ms]
constexpr int most_copies = 3;          // of this process, where one after the other comes to rest; a choice

bool is_child = false;

struct Header {
    std::uint64_t magic, size;
};

/// Address space of this process [bytes].
double address_space() {
    double pages = 0;
    std::ifstream("/proc/self/statm") >> pages;
    return pages * static_cast<double>(sysconf(_SC_PAGESIZE));
}

void limit(int resource, double value) {
    rlimit now{};
    if (getrlimit(static_cast<__rlimit_resource>(resource), &now) != 0) return;
    const auto most = static_cast<double>(now.rlim_max);
    now.rlim_cur = now.rlim_max == RLIM_INFINITY || value < most ? static_cast<rlim_t>(value) : now.rlim_max;
    setrlimit(static_cast<__rlimit_resource>(resource), &now);
}

bool write_all(int pipe, const void* data, std::size_t size) {
    const char* at = static_cast<const char*>(data);
    while (size > 0) {
        const ssize_t written = write(pipe, at, size);
        if (written < 0 && errno == EINTR) continue;
        if (written <= 0) return false;
        at += written;
        size -= static_cast<std::size_t>(written);
    }
    return true;
}

/// Ends the child with its parent, and closes what the parent has open: a lock that the parent holds on a file would
/// outlive it otherwise.
void cling_to(pid_t parent, int pipe) {
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (getppid() != parent) _exit(exception_code);  // it died before we asked to be told
    const auto end = static_cast<unsigned>(pipe);
    if (end > STDERR_FILENO + 1) close_range(STDERR_FILENO + 1, end - 1, 0);
    close_range(end + 1, ~0U, 0);
}

/// The child's life. Nothing of the parent is torn down: it leaves by _exit.
[[noreturn]] void live(const std::function<std::string()>& work, const ChildLimits& limits, double base, pid_t parent,
                       int pipe) {
    cling_to(parent, pipe);
    is_child = true;
    for (const int signal : {SIGSEGV, SIGBUS, SIGABRT, SIGFPE, SIGILL, SIGXCPU, SIGPIPE, SIGINT, SIGTERM})
        std::signal(signal, SIG_DFL);
    const int nowhere = open("/dev/null", O_RDWR);
    dup2(nowhere, STDOUT_FILENO);
    dup2(nowhere, STDERR_FILENO);
    close(nowhere);
    limit(RLIMIT_CORE, 0);
    limit(RLIMIT_CPU, std::ceil(limits.seconds) + 1);
    limit(RLIMIT_AS, base + limits.mebibytes * 1024 * 1024);
    try {
        const std::string answer = work();
        const Header header{magic, answer.size()};
        const bool is_sent = write_all(pipe, &header, sizeof header) && write_all(pipe, answer.data(), answer.size());
        _exit(is_sent ? 0 : exception_code);
    } catch (const std::bad_alloc&) {
        _exit(memory_code);
    } catch (...) {
        _exit(exception_code);
    }
}

enum class Reading { Whole, Broken, Late, AtRest };

struct Child {
    pid_t process = -1;
    int pipe = -1;  // its answer comes through
};

Child begin_child(const std::function<std::string()>& work, const ChildLimits& limits) {
    const double base = address_space();
    const pid_t parent = getpid();
    int ends[2];
    // One at a time: another child must not inherit our writing end, or we would never see it close.
    static std::mutex one_at_a_time;
    std::unique_lock lock(one_at_a_time);
    if (pipe2(ends, O_CLOEXEC) != 0)
        throw SolverFailure(fmt::format("No pipe to a child process can be made: {}. Close open files and try again.",
                                        std::strerror(errno)));
    const pid_t child = fork();
    if (child == 0) {
        lock.unlock();  // it may begin children of its own
        live(work, limits, base, parent, ends[1]);
    }
    const int error = errno;
    close(ends[1]);
    if (child < 0) {
        close(ends[0]);
        throw SolverFailure(fmt::format("No child process can be started: {}. Free memory or processes and try again.",
                                        std::strerror(error)));
    }
    return {child, ends[0]};
}

/// What of a child is waited for, and for how long.
struct Patience {
    Clock::time_point deadline;
    double rest;  // [s]
    RestOf child;
};

/// Reads up to `size` bytes, or until the other end closes, or patience ends. @throws what an interruption throws.
Reading read_all(int pipe, char* at, std::size_t size, Patience& patience) {
    while (size > 0) {
        const auto left =
            std::chrono::duration_cast<std::chrono::milliseconds>(patience.deadline - Clock::now()).count();
        if (left <= 0) return Reading::Late;
        pollfd waiting{pipe, POLLIN, 0};
        const int ready = poll(&waiting, 1, static_cast<int>(std::min<long long>(left, asked_every)));
        if (ready < 0 && errno != EINTR) return Reading::Broken;
        if (ready <= 0) {
            Interruption::ask();
            if (patience.child.seconds() > patience.rest) return Reading::AtRest;
            continue;
        }
        const ssize_t got = read(pipe, at, size);
        if (got < 0 && (errno == EINTR || errno == EAGAIN)) continue;
        if (got <= 0) return Reading::Broken;
        at += got;
        size -= static_cast<std::size_t>(got);
    }
    return Reading::Whole;
}

Reading read_answer(int pipe, std::string& answer, const ChildLimits& limits, Patience patience) {
    Header header{};
    const Reading begun = read_all(pipe, reinterpret_cast<char*>(&header), sizeof header, patience);
    if (begun != Reading::Whole) return begun;
    if (header.magic != magic || static_cast<double>(header.size) > limits.mebibytes * 1024 * 1024)
        return Reading::Broken;
    answer.resize(header.size);
    return read_all(pipe, answer.data(), answer.size(), patience);
}

int wait_for(pid_t child) {
    int status = 0;
    while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
    }
    return status;
}

}  // namespace

bool is_child_process() { return is_child; }

ChildResult run_in_child(const std::function<std::string()>& work, const ChildLimits& limits) {
    constexpr double on_a_busy_machine = 4;  // of wall time, where the processor is shared: what comes out is the same
    const auto time = std::chrono::microseconds(static_cast<long long>(on_a_busy_machine * limits.seconds * 1e6));

    ChildResult result;
    Reading reading = Reading::AtRest;
    int status = 0;
    for (int copy = 1; reading == Reading::AtRest; ++copy) {
        const Child child = begin_child(work, limits);
        const double rest = copy < most_copies ? limits.rest : std::numeric_limits<double>::infinity();
        try {
            reading =
                read_answer(child.pipe, result.answer, limits, {Clock::now() + time, rest, RestOf(child.process)});
        } catch (...) {
            kill(child.process, SIGKILL);
            wait_for(child.process);
            close(child.pipe);
            throw;
        }
        if (reading == Reading::Late || reading == Reading::AtRest) kill(child.process, SIGKILL);
        close(child.pipe);
        status = wait_for(child.process);
    }

    // What it died of, in the order of what is sure.
    using End = ChildResult::End;
    if (reading == Reading::Whole) {
        result.end = End::Answered;
        return result;
    }
    result.answer.clear();
    if (WIFSIGNALED(status)) result.signal = WTERMSIG(status);
    if (WIFEXITED(status)) result.code = WEXITSTATUS(status);
    if (reading == Reading::Late || result.signal == SIGXCPU)
        result.end = End::OutOfTime;
    else if (result.code == memory_code)
        result.end = End::OutOfMemory;
    else
        result.end = WIFSIGNALED(status) ? End::Crashed : End::Failed;
    return result;
}

}  // namespace palpate::mesh
