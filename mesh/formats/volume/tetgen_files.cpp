#include <fmt/format.h>

#include <algorithm>

#include "mesh/errors.h"
#include "mesh/formats/volume/elements.h"
#include "mesh/text/atomic_file.h"
#include "mesh/text/text_lines.h"

namespace palpate::mesh {
namespace {

/// A count at the head of a file, and lines to come that can hold so many.
int read_head_count(TextLines& lines, const std::filesystem::path& file, std::string_view what) {
    if (!lines.next()) throw InvalidInput(fmt::format("{}: is empty. Export the mesh again.", file.string()));
    const int count = lines.integer(0, what);
    if (count < 1 || static_cast<std::size_t>(count) > lines.left() / 4 + 1)
        throw InvalidInput(fmt::format("{}: {} is {}, but only {} bytes follow. The file is cut off: export it again.",
                                       lines.where(), what, count, lines.left()));
    return count;
}

void need_row(TextLines& lines, const std::filesystem::path& file, int found, int promised) {
    if (!lines.next())
        throw InvalidInput(fmt::format("{}: ends after {} of {} lines. It is cut off: export or copy it again.",
                                       file.string(), found, promised));
}

void read_nodes(const std::filesystem::path& file, Elements& elements) {
    const std::string content = read_text(file);
    TextLines lines(content, file);
    const int count = read_head_count(lines, file, "the number of nodes");
    for (int i = 0; i < count; ++i) {
        need_row(lines, file, i, count);
        elements.node_numbers.push_back(lines.integer(0, "a node's number"));
        elements.nodes.push_back(lines.position(1));
    }
}

}  // namespace

std::filesystem::path tetgen_node_file(const std::filesystem::path& file) {
    return std::filesystem::path(file).replace_extension(".node");
}
std::filesystem::path tetgen_element_file(const std::filesystem::path& file) {
    return std::filesystem::path(file).replace_extension(".ele");
}

Elements read_tetgen(const std::filesystem::path& file) {
    const std::filesystem::path nodes = tetgen_node_file(file), tetrahedra = tetgen_element_file(file);
    for (const auto& [needed, what] : {std::pair(nodes, "nodes"), std::pair(tetrahedra, "tetrahedra")})
        if (!std::filesystem::exists(needed))
            throw IoError(fmt::format(
                "{}: its {} stand in {}, which is not there. Put TetGen's .node and .ele files side by side.",
                file.string(), what, needed.string()));
    Elements elements;
    read_nodes(nodes, elements);

    const std::string content = read_text(tetrahedra);
    TextLines lines(content, tetrahedra);
    const int count = read_head_count(lines, tetrahedra, "the number of tetrahedra");
    const int corners = lines.integer(1, "the number of nodes a tetrahedron");
    if (corners != 4 && corners != 10)
        throw InvalidInput(fmt::format("{}: {} nodes a tetrahedron; 4 and 10 are allowed.", lines.where(), corners));
    const bool has_region = lines.words().size() > 2 && lines.integer(2, "the number of attributes") > 0;
    // TetGen's midsides lie on the edges (2,3) (0,3) (0,1) (1,2) (1,3) (0,2).
    constexpr std::array<std::size_t, 6> order_of_vtk{6, 7, 9, 5, 8, 4};
    for (int e = 0; e < count; ++e) {
        need_row(lines, tetrahedra, e, count);
        std::vector<std::int64_t> row(static_cast<std::size_t>(corners));
        for (std::size_t c = 0; c < row.size(); ++c) row[c] = lines.integer(c + 1, "a node of a tetrahedron");
        std::vector<std::int64_t> ordered(row.begin(), row.begin() + 4);
        for (std::size_t m = 0; m < 6 && corners == 10; ++m) ordered.push_back(row[order_of_vtk[m]]);
        elements.add(lines.integer(0, "a tetrahedron's number"), ordered, lines.where());
        if (has_region)
            elements.materials.push_back(
                static_cast<std::int64_t>(lines.number(static_cast<std::size_t>(corners + 1), "the region")));
    }
    return elements;
}

}  // namespace palpate::mesh
