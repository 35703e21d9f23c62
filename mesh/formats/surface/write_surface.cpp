#include <fmt/format.h>

#include <cstdint>
#include <string>

#include "mesh/errors.h"
#include "mesh/formats/surface/read_surface.h"
#include "mesh/formats/surface/surface_formats.h"
#include "mesh/formats/vtk/vtk_files.h"
#include "mesh/text/atomic_file.h"

namespace palpate::mesh {
namespace {

template <class T>
void append(std::string& bytes, const T& value) {
    bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}

std::string binary_stl(const Surface& surface) {
    std::string bytes = "binary STL, millimetres";
    bytes.resize(80, ' ');
    append(bytes, static_cast<std::uint32_t>(surface.triangles.rows()));
    const Points normals = area_vectors(surface).rowwise().normalized();
    for (Eigen::Index t = 0; t < surface.triangles.rows(); ++t) {
        for (int c = 0; c < 3; ++c) append(bytes, static_cast<float>(normals(t, c)));
        for (int i = 0; i < 3; ++i)
            for (int c = 0; c < 3; ++c) append(bytes, static_cast<float>(surface.vertices(surface.triangles(t, i), c)));
        append(bytes, std::uint16_t{0});
    }
    return bytes;
}

/// A line per vertex and per face; the shortest decimals that read back to the same number.
std::string lines(const Surface& surface, const std::string& vertex_prefix, const std::string& face_prefix,
                  int first_index) {
    std::string text;
    for (const auto& v : surface.vertices.rowwise())
        text += fmt::format("{}{} {} {}\n", vertex_prefix, v[0], v[1], v[2]);
    for (const auto& t : surface.triangles.rowwise())
        text += fmt::format("{}{} {} {}\n", face_prefix, t[0] + first_index, t[1] + first_index, t[2] + first_index);
    return text;
}

}  // namespace

void write_stl(const std::filesystem::path& file, const Surface& surface) { write_text(file, binary_stl(surface)); }

void write_obj(const std::filesystem::path& file, const Surface& surface) {
    write_text(file, lines(surface, "v ", "f ", 1));
}

void write_ply(const std::filesystem::path& file, const Surface& surface) {
    write_text(file,
               fmt::format("ply\nformat ascii 1.0\nelement vertex {}\nproperty double x\nproperty double y\nproperty "
                           "double z\nelement face {}\nproperty list uchar int vertex_indices\nend_header\n{}",
                           surface.vertices.rows(), surface.triangles.rows(), lines(surface, "", "3 ", 0)));
}

void write_off(const std::filesystem::path& file, const Surface& surface) {
    write_text(file, fmt::format("OFF\n{} {} 0\n{}", surface.vertices.rows(), surface.triangles.rows(),
                                 lines(surface, "", "3 ", 0)));
}

void write_bare_vtp(const std::filesystem::path& file, const Surface& surface) { write_vtp(file, surface); }

void write_surface(const std::filesystem::path& file, const Surface& surface) {
    const SurfaceFormat* format = surface_format_of(file);
    if (!format || !format->write)
        throw InvalidInput(
            fmt::format("{}: no surface can be written with the extension '{}'; allowed are {}. Name the "
                        "file with one of them.",
                        file.string(), file.extension().string(), written_surface_extensions()));
    format->write(file, surface);
}

}  // namespace palpate::mesh
