#pragma once

#include <fmt/format.h>

#include <filesystem>
#include <string>
#include <utility>

#include "mesh/errors.h"
#include "mesh/system/bytes.h"
#include "mesh/system/child_process.h"

namespace palpate::identify {

/// What `read` makes of a binary file, in a child process: libraries that trust what a file says of its sizes do no
/// harm there, nor where they come to no end of a broken one. `Data` goes through cereal.
/// @param kind of files, for messages ("MATLAB")
/// @param most_packed how many times as large as the file its content may be
/// @throws InvalidInput what `read` refuses, and where it crashes or does not end
template <class Data, class Read>
Data read_in_child(const std::filesystem::path& file, const char* kind, double most_packed, const Read& read) {
    constexpr double seconds = 5, bytes_a_second = 5e6;  // a slow disk's
    constexpr double mebibytes = 1024;
    std::error_code unreadable;
    const double bytes = static_cast<double>(std::filesystem::file_size(file, unreadable));
    const mesh::ChildLimits limits{.seconds = seconds + bytes / bytes_a_second,
                                   .mebibytes = mebibytes + most_packed * bytes / (1 << 20)};
    mesh::ChildResult child = mesh::run_in_child(
        [&] {
            std::string refusal;
            Data data;
            try {
                data = read(file);
            } catch (const InvalidInput& error) {
                refusal = error.what();
            }
            return mesh::to_bytes(refusal, data);
        },
        limits);
    if (child.end != mesh::ChildResult::End::Answered)
        throw InvalidInput(
            fmt::format("{}: breaks what reads {} files, or keeps it busy without end. The file is "
                        "broken: save it again.",
                        file.filename().string(), kind));
    std::string refusal;
    Data data;
    mesh::from_bytes(std::move(child.answer), refusal, data);
    if (!refusal.empty()) throw InvalidInput(refusal);
    return data;
}

}  // namespace palpate::identify
