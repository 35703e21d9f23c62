#include "mesh/text/atomic_file.h"

#include <fmt/format.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <iterator>

#include "mesh/errors.h"
#include "mesh/text/unfinished.h"

namespace palpate::mesh {

namespace fs = std::filesystem;

void write_whole(const fs::path& target, const std::function<void(const fs::path&)>& write) {
    std::error_code error;
    if (fs::is_directory(target))
        throw IoError(fmt::format("{}: cannot be written, a folder of that name stands there.", target.string()));
    if (target.has_parent_path()) fs::create_directories(target.parent_path(), error);
    if (error)
        throw IoError(
            fmt::format("{}: the folder cannot be made ({}).", target.parent_path().string(), error.message()));

    const fs::path temporary = unfinished_beside(target);
    try {
        write(temporary);
        fs::rename(temporary, target, error);
        if (error) throw IoError(fmt::format("{}: cannot be written ({}).", target.string(), error.message()));
    } catch (...) {
        fs::remove(temporary, error);
        throw;
    }
}

void write_text(const fs::path& target, const std::string& text) {
    write_whole(target, [&](const fs::path& temporary) {
        std::ofstream stream(temporary, std::ios::binary);
        stream << text << std::flush;
        if (!stream) throw IoError(fmt::format("{}: cannot be written ({}).", target.string(), std::strerror(errno)));
    });
}

std::string read_text(const fs::path& file) {
    if (!fs::exists(file)) throw IoError(fmt::format("{}: no such file.", file.string()));
    if (fs::is_directory(file)) throw IoError(fmt::format("{}: is a folder, not a file.", file.string()));
    if (!fs::is_regular_file(file))
        throw IoError(
            fmt::format("{}: is a device or a pipe, not a file. Save what comes from it first.", file.string()));
    std::ifstream stream(file, std::ios::binary);
    std::string text{std::istreambuf_iterator<char>(stream), {}};
    if (!stream) throw IoError(fmt::format("{}: cannot be read ({}).", file.string(), std::strerror(errno)));
    return text;
}

}  // namespace palpate::mesh
