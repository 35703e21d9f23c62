#include "mesh/io/read_vtk.h"

#include <fmt/format.h>

#include <fstream>
#include <regex>
#include <string>

#include "mesh/errors.h"
#include "mesh/io/child_process.h"

namespace palpate::mesh {
namespace {

constexpr double entries_per_byte = 1000;   // zlib packs no denser
constexpr std::size_t most_head = 1 << 20;  // [bytes] that are looked through

void read_guarded(const std::filesystem::path& file, std::string_view head, double bytes,
                  const std::function<void()>& read) {
    static const std::regex count(R"re(NumberOf\w+\s*=\s*["']\s*(\d+))re");
    head = head.substr(0, head.find("<AppendedData"));
    for (auto it = std::cregex_iterator(head.data(), head.data() + head.size(), count); it != std::cregex_iterator();
         ++it) {
        if (std::stod((*it)[1].str()) > entries_per_byte * bytes) {
            throw InvalidInput(
                fmt::format("{}: announces {} entries in {} bytes. The file is cut off or broken: write it again.",
                            file.string(), (*it)[1].str(), bytes));
        }
    }
    // VTK's parser goes beyond its arrays where a compressed block lies: a child finds out
    const auto rehearse = [&] {
        read();
        return std::string("read");
    };
    if (run_in_child(rehearse, {.seconds = 120, .mebibytes = 4096}).end != ChildResult::End::Answered) {
        throw InvalidInput(fmt::format(
            "{}: breaks what reads VTK files, or asks for more than 4 GiB. The file is broken: write it again.",
            file.string()));
    }
    read();
}

}  // namespace

void read_vtk(const std::filesystem::path& file, std::string_view content, const std::function<void()>& read) {
    read_guarded(file, content.substr(0, most_head), static_cast<double>(content.size()), read);
}

void read_vtk(const std::filesystem::path& file, const std::function<void()>& read) {
    std::string head(most_head, '\0');
    std::ifstream stream(file, std::ios::binary);
    stream.read(head.data(), static_cast<std::streamsize>(head.size()));
    head.resize(static_cast<std::size_t>(stream.gcount()));
    std::error_code error;
    read_guarded(file, head, static_cast<double>(std::filesystem::file_size(file, error)), read);
}

}  // namespace palpate::mesh
