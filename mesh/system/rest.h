#pragma once

#include <sys/types.h>

#include <chrono>
#include <optional>

namespace palpate::mesh {

/// Tells whether a process is at rest: every thread of it sleeps, and none was woken in between. A computation never
/// is; a process that waits for a lock that nobody will open is, for good.
class RestOf {
public:
    explicit RestOf(pid_t process) : process_(process) {}

    /// For how long, as far as the calls of this function tell [s]. 0 where /proc says nothing of it.
    double seconds();

private:
    using Clock = std::chrono::steady_clock;

    pid_t process_;
    std::optional<long long> switches_;  // of all its threads, when it was seen asleep last
    Clock::time_point since_ = Clock::now();
};

}  // namespace palpate::mesh
