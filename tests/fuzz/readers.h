#pragma once

#include <filesystem>
#include <functional>
#include <vector>

namespace palpate::fuzz {

/// A file of a sound input that is broken, and what reads the input.
struct Reader {
    const char* name;
    std::function<std::filesystem::path(const std::filesystem::path& folder)>
        make;  // writes the input, returns the file to break
    std::function<void(const std::filesystem::path& folder)> read;
};

/// Every reader of what users bring, with a small sound input.
std::vector<Reader> all_readers();

}  // namespace palpate::fuzz
