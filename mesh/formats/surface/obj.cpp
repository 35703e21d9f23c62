#include <fmt/format.h>

#include "mesh/errors.h"
#include "mesh/formats/surface/surface_formats.h"
#include "mesh/text/text_lines.h"
#include "mesh/text/words.h"

namespace palpate::mesh {

/// Vertices (v) and faces (f, with v, v/vt, v//vn, v/vt/vn); all other lines are for pictures.
Polygons read_obj(const std::string& content, const std::filesystem::path& file) {
    Polygons polygons;
    polygons.first_index = 1;
    TextLines lines(content, file, TextLines::Continuation::Backslash);
    while (lines.next()) {
        const auto& words = lines.words();
        if (words[0] == "v") {
            polygons.points.push_back(lines.position(1));
        } else if (words[0] == "f") {
            polygons.begin_polygon(lines.line());
            for (std::size_t i = 1; i < words.size(); ++i) {
                const auto index = parse_integer(words[i].substr(0, words[i].find('/')));
                if (!index || *index == 0)
                    throw InvalidInput(
                        fmt::format("{}: the corner {} names no vertex; 1 and up are allowed, or -1 and down "
                                    "from the last. Mend the line, or export the surface again.",
                                    lines.where(), cited(words[i])));
                const auto so_far = static_cast<long>(polygons.points.size());
                if (*index < -so_far)
                    throw InvalidInput(
                        fmt::format("{}: vertex {} does not exist; {} vertices stand above this line. Mend the "
                                    "face, or export the surface again.",
                                    lines.where(), *index, so_far));
                polygons.corners.push_back(*index > 0 ? *index - 1 : static_cast<int>(so_far + *index));
            }
        }
    }
    if (polygons.points.empty() && polygons.begins.empty())
        throw InvalidInput(fmt::format(
            "{}: no line of it begins with 'v' or 'f', it is no OBJ. Is the extension right?", file.string()));
    return polygons;
}

}  // namespace palpate::mesh
