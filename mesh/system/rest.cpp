#include "mesh/system/rest.h"

#include <fmt/format.h>

#include <filesystem>
#include <fstream>
#include <string>

namespace palpate::mesh {
namespace {

/// How often the threads of a process were put aside or to sleep so far; none where one of them is awake.
std::optional<long long> switches_asleep(pid_t process) {
    std::error_code error;
    const std::filesystem::directory_iterator threads(fmt::format("/proc/{}/task", process), error);
    if (error) return std::nullopt;
    long long switches = 0;
    for (const auto& thread : threads) {
        std::ifstream status(thread.path() / "status");
        for (std::string key, value; status >> key;) {
            if (key != "State:" && !key.ends_with("ctxt_switches:")) continue;
            status >> value;
            if (key != "State:")
                switches += std::stoll(value);
            else if (value != "S")
                return std::nullopt;
        }
    }
    return switches;
}

}  // namespace

double RestOf::seconds() {
    const auto now = Clock::now();
    const std::optional<long long> switches = switches_asleep(process_);
    if (!switches || switches != switches_) since_ = now;
    switches_ = switches;
    return std::chrono::duration<double>(now - since_).count();
}

}  // namespace palpate::mesh
