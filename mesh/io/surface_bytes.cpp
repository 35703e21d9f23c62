#include "mesh/io/surface_bytes.h"

#include <cstdint>
#include <cstring>

namespace palpate::mesh {

std::string to_bytes(const Surface& surface) {
    const std::int64_t counts[2] = {surface.vertices.rows(), surface.triangles.rows()};
    const auto points = static_cast<std::size_t>(surface.vertices.size()) * sizeof(double);
    const auto corners = static_cast<std::size_t>(surface.triangles.size()) * sizeof(int);
    std::string bytes(reinterpret_cast<const char*>(counts), sizeof counts);
    if (points > 0) bytes.append(reinterpret_cast<const char*>(surface.vertices.data()), points);
    if (corners > 0) bytes.append(reinterpret_cast<const char*>(surface.triangles.data()), corners);
    return bytes;
}

Surface surface_from_bytes(std::string_view bytes) {
    std::int64_t counts[2] = {0, 0};
    if (bytes.size() < sizeof counts) return {};
    std::memcpy(counts, bytes.data(), sizeof counts);
    const auto left = static_cast<std::int64_t>(bytes.size() - sizeof counts);
    const std::int64_t point = 3 * sizeof(double), corner = 3 * sizeof(int);
    if (counts[0] < 0 || counts[1] < 0 || counts[0] > left || counts[1] > left ||
        left != counts[0] * point + counts[1] * corner)
        return {};
    Surface surface{Points(counts[0], 3), Triangles(counts[1], 3)};
    const char* at = bytes.data() + sizeof counts;
    if (counts[0] > 0) std::memcpy(surface.vertices.data(), at, static_cast<std::size_t>(counts[0] * point));
    if (counts[1] > 0)
        std::memcpy(surface.triangles.data(), at + counts[0] * point, static_cast<std::size_t>(counts[1] * corner));
    return surface;
}

}  // namespace palpate::mesh
