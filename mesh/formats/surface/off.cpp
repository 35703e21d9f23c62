#include <fmt/format.h>

#include "mesh/errors.h"
#include "mesh/formats/surface/surface_formats.h"
#include "mesh/text/text_lines.h"
#include "mesh/text/words.h"

namespace palpate::mesh {
namespace {

void need_line(TextLines& lines, const std::filesystem::path& file, std::string_view what, int found, int promised) {
    if (lines.next()) return;
    throw InvalidInput(fmt::format("{}: ends after {} of {} {}. The file is cut off: export or copy it again.",
                                   file.string(), found, promised, what));
}

int read_count(const TextLines& lines, std::size_t i, std::string_view what) {
    const int count = lines.integer(i, what);
    // Each takes at least six characters ("0 0 0" and a line end): a promise of more is not worth memory.
    if (count < 0 || static_cast<std::size_t>(count) > lines.left() / 6 + 1)
        throw InvalidInput(
            fmt::format("{}: {} is {}, but only {} bytes follow. The file is cut off, or its head is wrong: "
                        "export it again.",
                        lines.where(), what, count, lines.left()));
    return count;
}

}  // namespace

/// Text OFF, with or without colours or normals (COFF, NOFF, ...), which are not used.
Polygons read_off(const std::string& content, const std::filesystem::path& file) {
    TextLines lines(content, file);
    const bool begun = lines.next();
    const std::string_view head = begun ? lines.words()[0] : std::string_view();
    if (!head.ends_with("OFF") || head.starts_with('4') || head.starts_with('n') ||
        (lines.words().size() > 1 && lines.words()[1] == "BINARY"))
        throw InvalidInput(
            fmt::format("{}, line {}: begins with {}; 'OFF', 'COFF' or 'NOFF', in text, is allowed. Export the surface "
                        "as a text OFF.",
                        file.string(), lines.line(), cited(head)));
    std::size_t at = 1;
    if (lines.words().size() == 1) {
        need_line(lines, file, "lines of counts", 0, 1);
        at = 0;
    }
    const int vertices = read_count(lines, at, "the number of vertices");
    const int faces = read_count(lines, at + 1, "the number of faces");

    Polygons polygons;
    for (int v = 0; v < vertices; ++v) {
        need_line(lines, file, "vertices", v, vertices);
        polygons.points.push_back(lines.position(0));
    }
    for (int f = 0; f < faces; ++f) {
        need_line(lines, file, "faces", f, faces);
        polygons.begin_polygon(lines.line());
        const int corners = lines.integer(0, "the number of corners");
        for (int i = 1; i <= corners; ++i)
            polygons.corners.push_back(lines.integer(static_cast<std::size_t>(i), "the vertex of a corner"));
    }
    return polygons;
}

}  // namespace palpate::mesh
