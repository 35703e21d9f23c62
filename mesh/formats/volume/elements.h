#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "mesh/core/volume_mesh.h"

namespace palpate::mesh {

/// What a file of a volume mesh holds, before it is looked at: nodes under the file's own numbers, tetrahedra that
/// name them, in VTK's order.
struct Elements {
    std::vector<std::int64_t> node_numbers;
    std::vector<Vec3> nodes;
    int nodes_per_element = 0;                  // 4 or 10; 0: no element yet
    std::vector<std::int64_t> corners;          // of all elements, node numbers, one after the other
    std::vector<std::int64_t> element_numbers;  // as the file counts them
    std::vector<std::int64_t> materials;        // one an element, or none at all

    /// @throws InvalidInput when the elements before it have another number of nodes.
    void add(std::int64_t number, const std::vector<std::int64_t>& element_nodes, const std::string& where);
};

/// The body of those elements, in their order. Elements that are numbered inside out are turned, equal nodes become
/// one, nodes of no element are left out; what was done stands in `notes`. `row_of_node` (when asked for) tells which
/// of the elements' nodes each of the body's is.
/// @throws InvalidInput naming node or element: no elements, a node that does not exist, an element without volume,
/// a midside node away from its edge, a side that more than two elements share.
VolumeMesh assemble(const Elements& elements, const std::filesystem::path& file, std::vector<std::string>& notes,
                    std::vector<int>* row_of_node = nullptr);

/// Several materials, which the body is taken to be one of.
void note_materials(const Elements& elements, std::vector<std::string>& notes);

/// One reader a format, tetrahedra with 4 or 10 nodes; elements of lower dimension are skipped, other solid ones
/// refused. @throws IoError, InvalidInput with file and line, byte or element.
Elements read_vtu_elements(const std::filesystem::path& file);
Elements read_gmsh(const std::filesystem::path& file);
Elements read_medit(const std::filesystem::path& file);
/// Of the two files of TetGen, given one.
Elements read_tetgen(const std::filesystem::path& file);
std::filesystem::path tetgen_node_file(const std::filesystem::path& file);
std::filesystem::path tetgen_element_file(const std::filesystem::path& file);

}  // namespace palpate::mesh
