#include "mesh/formats/deck/cells.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <utility>

#include "mesh/text/words.h"

namespace palpate::mesh {
namespace {

/// Sides of a shape by its corners; a triangle repeats its last corner.
using Side = std::array<int, 4>;
const std::vector<Side>& sides_of(CellShape shape) {
    static const std::vector<Side> tetrahedron{{0, 1, 2, 2}, {0, 1, 3, 3}, {1, 2, 3, 3}, {0, 2, 3, 3}};
    static const std::vector<Side> pyramid{{0, 1, 2, 3}, {0, 1, 4, 4}, {1, 2, 4, 4}, {2, 3, 4, 4}, {3, 0, 4, 4}};
    static const std::vector<Side> wedge{{0, 1, 2, 2}, {3, 4, 5, 5}, {0, 1, 4, 3}, {1, 2, 5, 4}, {2, 0, 3, 5}};
    static const std::vector<Side> hexahedron{{0, 1, 2, 3}, {4, 5, 6, 7}, {0, 1, 5, 4},
                                              {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}};
    switch (shape) {
        case CellShape::tetrahedron:
            return tetrahedron;
        case CellShape::pyramid:
            return pyramid;
        case CellShape::wedge:
            return wedge;
        case CellShape::hexahedron:
            break;
    }
    return hexahedron;
}

/// Tetrahedra from the cell's smallest corner to all sides that do not hold it, each cut from its own smallest corner.
void cut(const Cells::Cell& cell, const std::string& where, Elements& elements) {
    const auto corners = static_cast<std::ptrdiff_t>(nodes_of(cell.shape).corners);
    const std::int64_t apex = *std::min_element(cell.nodes.begin(), cell.nodes.begin() + corners);
    for (const Side& side : sides_of(cell.shape)) {
        std::array<std::int64_t, 4> around{};
        std::ranges::transform(side, around.begin(), [&](int c) { return cell.nodes[static_cast<std::size_t>(c)]; });
        if (std::ranges::find(around, apex) != around.end()) continue;
        const bool is_triangle = side[2] == side[3];
        if (!is_triangle) std::rotate(around.begin(), std::ranges::min_element(around), around.end());
        elements.add(cell.number, {apex, around[0], around[1], around[2]}, where);
        if (!is_triangle) elements.add(cell.number, {apex, around[0], around[2], around[3]}, where);
    }
}

bool are_tetrahedra_of_one_kind(const std::vector<Cells::Cell>& cells) {
    return std::ranges::all_of(cells, [&](const Cells::Cell& cell) {
        return cell.shape == CellShape::tetrahedron && cell.nodes.size() == cells.front().nodes.size();
    });
}

}  // namespace

CellNodes nodes_of(CellShape shape) {
    switch (shape) {
        case CellShape::tetrahedron:
            return {4, 10};
        case CellShape::pyramid:
            return {5, 13};
        case CellShape::wedge:
            return {6, 15};
        case CellShape::hexahedron:
            break;
    }
    return {8, 20};
}

std::optional<CellShape> shape_of_type(const std::string& type) {
    if (!type.starts_with("C3D")) return std::nullopt;
    std::string_view digits = std::string_view(type).substr(3);
    digits = digits.substr(0, digits.find_first_not_of("0123456789"));
    for (const CellShape shape :
         {CellShape::tetrahedron, CellShape::pyramid, CellShape::wedge, CellShape::hexahedron}) {
        const CellNodes nodes = nodes_of(shape);
        if (digits == std::to_string(nodes.corners) || digits == std::to_string(nodes.all)) return shape;
    }
    return std::nullopt;
}

int nodes_of_type(const std::string& type) {
    const std::size_t from = type.find_first_of("0123456789", 2);
    return parse_integer(std::string_view(type).substr(from, type.find_first_not_of("0123456789", from) - from))
        .value_or(0);
}

Elements as_tetrahedra(const Cells& cells, std::vector<std::string>& notes) {
    Elements elements;
    elements.node_numbers = cells.node_numbers;
    elements.nodes = cells.nodes;
    const bool as_they_are = are_tetrahedra_of_one_kind(cells.cells);
    for (const Cells::Cell& cell : cells.cells) {
        const std::string where = fmt::format("element {}", cell.number);
        if (as_they_are) {
            elements.add(cell.number, cell.nodes, where);
        } else {
            cut(cell, where, elements);
        }
    }
    if (!as_they_are)
        notes.push_back(
            fmt::format("{} cells that are not all tetrahedra of one kind are cut into {} by their corners.",
                        cells.cells.size(), elements.element_numbers.size()));
    return elements;
}

}  // namespace palpate::mesh
