#include "mesh/text/unfinished.h"

#include <fmt/format.h>
#include <unistd.h>

#include <atomic>
#include <string>

namespace palpate::mesh {
namespace {

constexpr const char* mark = ".unfinished";

}  // namespace

std::filesystem::path unfinished_beside(const std::filesystem::path& target) {
    static std::atomic<int> count{0};
    return target.parent_path() /
           fmt::format(".{}.{}-{}{}{}", target.stem().string(), ::getpid(), count++, mark, target.extension().string());
}

bool is_unfinished(const std::filesystem::path& path) {
    const std::string name = path.filename().string();
    return name.starts_with('.') && name.find(mark) != std::string::npos;
}

}  // namespace palpate::mesh
