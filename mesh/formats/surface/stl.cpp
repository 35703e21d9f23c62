#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstring>

#include "mesh/errors.h"
#include "mesh/formats/surface/surface_formats.h"
#include "mesh/text/text_lines.h"
#include "mesh/text/words.h"

namespace palpate::mesh {
namespace {

constexpr std::size_t head_bytes = 84;      // 80 of comment, a count
constexpr std::size_t triangle_bytes = 50;  // normal, three corners, two spare

static_assert(std::endian::native == std::endian::little, "binary STL is little-endian");

template <class T>
T value_at(const std::string& content, std::size_t at) {
    T value;
    std::memcpy(&value, content.data() + at, sizeof value);
    return value;
}

/// No control characters but white space.
bool is_text(const std::string& content) {
    return std::none_of(content.begin(), content.end(), [](char c) {
        const auto byte = static_cast<unsigned char>(c);
        return byte < 32 && byte != '\n' && byte != '\r' && byte != '\t' && byte != '\v' && byte != '\f';
    });
}

void add_corner(Polygons& polygons, const Vec3& position) {
    polygons.corners.push_back(static_cast<int>(polygons.points.size()));
    polygons.points.push_back(position);
}

Polygons read_binary(const std::string& content, const std::filesystem::path& file) {
    if (content.size() < head_bytes)
        throw InvalidInput(
            fmt::format("{}: {} bytes are too few for a binary STL (at least {}). The file is cut off: export or "
                        "copy it again.",
                        file.string(), content.size(), head_bytes));
    const std::size_t count = value_at<std::uint32_t>(content, 80);
    const std::size_t needed = head_bytes + triangle_bytes * count;
    if (content.size() < needed)
        throw InvalidInput(
            fmt::format("{}: its head promises {} triangles ({} bytes), but it has {} bytes, enough for {}. The "
                        "file is cut off: export or copy it again.",
                        file.string(), count, needed, content.size(), (content.size() - head_bytes) / triangle_bytes));
    Polygons polygons;
    polygons.points.reserve(3 * count);
    for (std::size_t t = 0; t < count; ++t) {
        polygons.begin_polygon();
        for (std::size_t i = 0; i < 3; ++i) {
            const std::size_t at = head_bytes + triangle_bytes * t + 12 * (i + 1);
            const Vec3 corner(value_at<float>(content, at), value_at<float>(content, at + 4),
                              value_at<float>(content, at + 8));
            if (!(corner.array().abs() < beyond_all_units).all())
                throw InvalidInput(fmt::format(
                    "{}, triangle {} (from 0): the corner ({}, {}, {}) is not finite, or beyond 1e30. Export the "
                    "surface again without that triangle.",
                    file.string(), t, corner.x(), corner.y(), corner.z()));
            add_corner(polygons, corner);
        }
    }
    return polygons;
}

std::string lower(std::string_view word) {
    std::string result(word);
    std::transform(result.begin(), result.end(), result.begin(),
                   [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
    return result;
}

Polygons read_text_stl(const std::string& content, const std::filesystem::path& file) {
    Polygons polygons;
    TextLines lines(content, file);
    int corners = 0;
    bool in_solid = false, in_facet = false;
    while (lines.next()) {
        const std::string word = lower(lines.words()[0]);
        if (word == "solid") {
            in_solid = true;
        } else if (!in_solid) {
            throw InvalidInput(
                fmt::format("{}: {} is no STL: a text STL begins with 'solid', a binary one holds other bytes "
                            "than text. Is the extension right?",
                            lines.where(), cited(lines.words()[0])));
        } else if (word == "facet") {
            if (in_facet)
                throw InvalidInput(
                    fmt::format("{}: 'facet' within a facet; 'endfacet' is missing before it. Export "
                                "the surface again.",
                                lines.where()));
            in_facet = true;
            corners = 0;
            polygons.begin_polygon(lines.line());
        } else if (word == "vertex") {
            if (!in_facet)
                throw InvalidInput(
                    fmt::format("{}: 'vertex' outside of a facet. Export the surface again.", lines.where()));
            add_corner(polygons, lines.position(1));
            ++corners;
        } else if (word == "endfacet") {
            if (corners != 3)
                throw InvalidInput(
                    fmt::format("{}: a facet with {} corners; 3 are allowed. Export the surface "
                                "again.",
                                lines.where(), corners));
            in_facet = false;
        } else if (word == "endsolid") {
            in_solid = false;
        } else if (word != "outer" && word != "endloop") {
            throw InvalidInput(
                fmt::format("{}: {} is no word of a text STL (solid, facet, outer loop, vertex, endloop, "
                            "endfacet, endsolid). Export the surface again.",
                            lines.where(), cited(lines.words()[0])));
        }
    }
    if (in_solid)
        throw InvalidInput(
            fmt::format("{}: ends without 'endsolid' after {} triangles. The file is cut off: export or copy it "
                        "again.",
                        file.string(), polygons.begins.size()));
    return polygons;
}

}  // namespace

/// Binary files may begin with "solid" too: the size decides.
Polygons read_stl(const std::string& content, const std::filesystem::path& file) {
    const bool size_fits =
        content.size() >= head_bytes &&
        content.size() == head_bytes + triangle_bytes * std::size_t{value_at<std::uint32_t>(content, 80)};
    return size_fits || !is_text(content) ? read_binary(content, file) : read_text_stl(content, file);
}

}  // namespace palpate::mesh
