#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "mesh/formats/volume/elements.h"

namespace palpate::mesh {

/// Kinds of solid cells, with or without midsides; corners come first, in the order of VTK (which is Abaqus's).
enum class CellShape { tetrahedron, pyramid, wedge, hexahedron };

/// Solid cells as solvers list them, of several kinds side by side.
struct Cells {
    struct Cell {
        std::int64_t number;  // as the file counts
        CellShape shape;
        std::vector<std::int64_t> nodes;
    };
    std::vector<std::int64_t> node_numbers;
    std::vector<Vec3> nodes;
    std::vector<Cell> cells;
};

/// Nodes a cell of a shape has, without midsides and with them.
struct CellNodes {
    int corners, all;
};
CellNodes nodes_of(CellShape shape);

/// The shape behind an element's type in a deck, as "C3D10M" or "C3D8R"; none: no solid.
std::optional<CellShape> shape_of_type(const std::string& type);
/// The first number in such a type, of a solid or not, which names how many nodes it has; 0: none.
int nodes_of_type(const std::string& type);

/// The cells as tetrahedra. Those that all are tetrahedra with the same number of nodes stay as they are; else each is
/// cut by its corners, midsides left out, so that sides which two cells share are cut alike: all diagonals start from
/// the smallest node number [Dompierre et al. 1999]. `notes` says so.
Elements as_tetrahedra(const Cells& cells, std::vector<std::string>& notes);

}  // namespace palpate::mesh
