#include "mesh/formats/surface/read_surface.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string>

#include "mesh/errors.h"
#include "mesh/formats/surface/polygons.h"
#include "mesh/text/atomic_file.h"

namespace palpate::mesh {
namespace {

struct Format {
    const char* extension;
    Polygons (*read)(const std::string& content, const std::filesystem::path& file);
};

// A new one has to stand in read_body.cpp and write_surface.cpp, too.
constexpr std::array<Format, 5> formats{
    {{".stl", read_stl}, {".obj", read_obj}, {".ply", read_ply}, {".off", read_off}, {".vtp", read_vtp}}};

}  // namespace

std::string surface_extension(const std::filesystem::path& file) {
    std::string extension = file.extension().string();
    std::transform(extension.begin(), extension.end(), extension.begin(),
                   [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
    const bool known =
        std::any_of(formats.begin(), formats.end(), [&](const Format& f) { return extension == f.extension; });
    if (!known)
        throw InvalidInput(
            fmt::format("{}: the extension '{}' names no surface format; .stl, .obj, .ply, .off and .vtp are "
                        "allowed. Export the surface in one of them.",
                        file.string(), extension));
    return extension;
}

Surface read_surface(const std::filesystem::path& file) {
    const std::string extension = surface_extension(file);
    const std::string content = read_text(file);
    if (content.find_first_not_of(" \t\r\n") == std::string::npos)
        throw InvalidInput(
            fmt::format("{}: is empty ({} bytes). Export the surface again.", file.string(), content.size()));
    const auto format =
        std::find_if(formats.begin(), formats.end(), [&](const Format& f) { return extension == f.extension; });
    return triangulate(format->read(content, file), file);
}

}  // namespace palpate::mesh
