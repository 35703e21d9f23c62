#include <fmt/format.h>

#include <cstdint>
#include <string>

#include "mesh/formats/surface/read_surface.h"
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

void write_surface(const std::filesystem::path& file, const Surface& surface) {
    const std::string extension = surface_extension(file);
    const auto n = surface.vertices.rows(), m = surface.triangles.rows();
    if (extension == ".stl") {
        write_text(file, binary_stl(surface));
    } else if (extension == ".obj") {
        write_text(file, lines(surface, "v ", "f ", 1));
    } else if (extension == ".ply") {
        write_text(file, fmt::format(
                             "ply\nformat ascii 1.0\nelement vertex {}\nproperty double x\nproperty double y\nproperty "
                             "double z\nelement face {}\nproperty list uchar int vertex_indices\nend_header\n{}",
                             n, m, lines(surface, "", "3 ", 0)));
    } else if (extension == ".off") {
        write_text(file, fmt::format("OFF\n{} {} 0\n{}", n, m, lines(surface, "", "3 ", 0)));
    } else {  // .vtp
        write_vtp(file, surface);
    }
}

}  // namespace palpate::mesh
