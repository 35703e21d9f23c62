#pragma once

#include <functional>
#include <vector>

#include "fem/elements/dilatation.h"
#include "fem/material.h"
#include "mesh/core/volume_mesh.h"

namespace palpate::fem {

/// What one process holds of a body: its own nodes, and all elements that touch one of them.
struct BodyPart {
    mesh::VolumeMesh mesh;  // its own free nodes, then the others of its elements; no faces
    Materials materials;    // of its elements
    Dilatation dilatation = Dilatation::full;
    int first = 0, own = 0;   // rows of the whole matrix, in nodes
    std::vector<int> number;  // of each node in the whole matrix, -1: held
};

/// Free nodes numbered so that those of a part follow each other; parts share few elements and are about as large as
/// each other. [METIS: Karypis & Kumar 1998]
struct Partition {
    std::vector<int> number;  // of each node, -1: held
    std::vector<int> first;   // the number that each part begins with (parts + 1)
};

/// @throws SolverFailure when METIS finds none.
Partition partition_nodes(const mesh::VolumeMesh& mesh, const std::vector<char>& held, int parts);

BodyPart part_of(const mesh::VolumeMesh& mesh, const Materials& materials, Dilatation dilatation,
                 const Partition& partition, int part);

/// Calls work(begin, piece) with pieces of at most `size` of the part's own nodes, from node `begin` on, which are the
/// piece's own: what a piece takes is gone before the next.
void for_pieces(const BodyPart& part, int size, const std::function<void(int, const BodyPart&)>& work);

}  // namespace palpate::fem
