#include "fem/linear_algebra/memory/free_memory.h"

#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <limits>
#include <optional>
#include <string>

namespace palpate::fem {

namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();

/// The first number in a file [bytes]; none where there is no such file, or a word stands there.
std::optional<double> number_in(const char* path) {
    std::ifstream file(path);
    double number = 0;
    return file >> number ? std::optional(number) : std::nullopt;
}

/// What the machine has available [bytes].
double of_machine() {
    std::ifstream file("/proc/meminfo");
    std::string word;
    double kilobytes = 0;
    while (file >> word) {
        if (word == "MemAvailable:" && file >> kilobytes) return 1024 * kilobytes;
    }
    return infinite;
}

/// What the control group may still take [bytes].
double of_group() {
    const auto most = number_in("/sys/fs/cgroup/memory.max"), taken = number_in("/sys/fs/cgroup/memory.current");
    return most && taken ? std::max(0.0, *most - *taken) : infinite;
}

/// What the address space may still grow by [bytes].
double of_process() {
    rlimit limit{};
    if (getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) return infinite;
    const double pages = number_in("/proc/self/statm").value_or(0);
    return std::max(0.0, static_cast<double>(limit.rlim_cur) - pages * static_cast<double>(sysconf(_SC_PAGESIZE)));
}

}  // namespace

double free_memory() { return 1e-9 * std::min({of_machine(), of_group(), of_process()}); }

}  // namespace palpate::fem
