#pragma once

#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

// What every command takes and gives.

namespace palpate::pipeline::commands {

enum ExitCode { done = 0, internal_error = 1, wrong_usage = 2, bad_input = 3, numerical_failure = 4, not_met = 5 };

/// What every command understands.
struct Common {
    bool json = false;   // the result as one JSON object on standard output, nothing else there
    bool force = false;  // overwrite what palpate did not make
    int threads = 1;
    std::optional<std::uint64_t> seed;  // absent: the case's, or 1
};

/// What a command comes to: for people, for scripts, and for the shell.
struct Outcome {
    std::string text;
    nlohmann::json json;
    ExitCode code = done;
};

/// @throws InvalidInput when `target` exists, palpate did not make it, and `force` is false.
void refuse_to_overwrite(const std::filesystem::path& target, bool force);

}  // namespace palpate::pipeline::commands
