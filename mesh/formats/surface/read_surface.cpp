#include "mesh/formats/surface/read_surface.h"

#include <fmt/format.h>

#include <string>

#include "mesh/errors.h"
#include "mesh/formats/surface/surface_formats.h"
#include "mesh/text/atomic_file.h"

namespace palpate::mesh {

Surface read_surface(const std::filesystem::path& file) {
    const SurfaceFormat* format = surface_format_of(file);
    if (!format)
        throw InvalidInput(
            fmt::format("{}: the extension '{}' names no surface format; allowed are {}. Export the surface in one of "
                        "them.",
                        file.string(), file.extension().string(), surface_extensions()));
    const std::string content = read_text(file);
    if (content.find_first_not_of(" \t\r\n") == std::string::npos)
        throw InvalidInput(
            fmt::format("{}: is empty ({} bytes). Export the surface again.", file.string(), content.size()));
    return triangulate(format->read(content, file), file);
}

}  // namespace palpate::mesh
