#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "mesh/core/volume_mesh.h"
#include "mesh/formats/deck/deck.h"

namespace palpate::mesh {

/// What another program computed at one time.
struct SolvedStep {
    double time = 0;      // as the file tells it, else 0
    Points displacement;  // of each node (n x 3); NaN where none was written
    int load_step = 0;    // that it is an increment of; 0: not told
};

/// Displacement fields of another program, in its own units.
struct Solution {
    std::filesystem::path file;
    Points nodes;                     // at rest, as the file lists them (n x 3)
    VolumeMesh body;                  // its solid cells as tetrahedra; without any where the file holds a surface only
    std::vector<int> node_of_body;    // which of `nodes` each node of the body is
    Surface surface;                  // the body's boundary, or what the file holds
    std::vector<int> node_of_vertex;  // which of `nodes` each of its vertices is
    std::vector<SolvedStep> steps;
    std::vector<std::string> notes;  // what was done in reading it, in words
};

/// Nodes, body and surface out of cells. @throws InvalidInput as assemble.
void set_mesh(Solution& solution, const Cells& cells);

/// A deck's mesh, without displacements. @throws InvalidInput as assemble.
Solution mesh_of(const Deck& deck);

}  // namespace palpate::mesh
