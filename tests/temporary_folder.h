#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <initializer_list>
#include <string>

namespace palpate {

/// A folder of the test's own, gone when it ends.
class TemporaryFolder {
public:
    TemporaryFolder() {
        static int count = 0;
        path_ = std::filesystem::temp_directory_path() /
                ("palpate-test-" + std::to_string(::getpid()) + "-" + std::to_string(count++));
        std::filesystem::create_directories(path_);
    }
    ~TemporaryFolder() { std::filesystem::remove_all(path_); }
    TemporaryFolder(const TemporaryFolder&) = delete;
    TemporaryFolder& operator=(const TemporaryFolder&) = delete;

    std::filesystem::path operator/(const std::string& name) const { return path_ / name; }
    const std::filesystem::path& path() const { return path_; }

    /// A file with this text in it.
    std::filesystem::path write(const std::string& name, const std::string& text) const {
        std::filesystem::create_directories((path_ / name).parent_path());
        std::ofstream(path_ / name, std::ios::binary) << text;
        return path_ / name;
    }

private:
    std::filesystem::path path_;
};

/// What `action` says when it throws an Error; "" when it does not throw.
template <class Error, class Action>
std::string message_of(Action&& action) {
    try {
        action();
    } catch (const Error& error) {
        return error.what();
    }
    return "";
}

/// Does a message hold all of these words?
inline ::testing::AssertionResult says(const std::string& message, std::initializer_list<const char*> words) {
    if (message.empty()) return ::testing::AssertionFailure() << "nothing was refused";
    for (const char* word : words)
        if (message.find(word) == std::string::npos)
            return ::testing::AssertionFailure() << "'" << word << "' is not in: " << message;
    return ::testing::AssertionSuccess();
}

}  // namespace palpate
