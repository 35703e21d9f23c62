#include "mesh/formats/surface/surface_formats.h"

#include <algorithm>
#include <array>

namespace palpate::mesh {
namespace {

constexpr std::array formats{
    SurfaceFormat{".stl", read_stl, write_stl},      SurfaceFormat{".obj", read_obj, write_obj},
    SurfaceFormat{".ply", read_ply, write_ply},      SurfaceFormat{".off", read_off, write_off},
    SurfaceFormat{".vtp", read_vtp, write_bare_vtp},
};

template <typename Condition>
std::string extensions_where(Condition&& condition) {
    std::string list;
    for (const SurfaceFormat& format : formats)
        if (condition(format)) list += (list.empty() ? "" : ", ") + std::string(format.extension);
    return list;
}

}  // namespace

std::span<const SurfaceFormat> surface_formats() { return formats; }

const SurfaceFormat* surface_format_of(const std::filesystem::path& file) {
    std::string extension = file.extension().string();
    std::ranges::transform(extension, extension.begin(),
                           [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
    const auto found = std::ranges::find_if(formats, [&](const SurfaceFormat& f) { return extension == f.extension; });
    return found == formats.end() ? nullptr : &*found;
}

std::string surface_extensions() {
    return extensions_where([](const SurfaceFormat&) { return true; });
}

std::string written_surface_extensions() {
    return extensions_where([](const SurfaceFormat& format) { return format.write != nullptr; });
}

}  // namespace palpate::mesh
