#pragma once

#include <Eigen/SparseCore>
#include <cstdint>
#include <vector>

#include "fem/elements/dilatation.h"
#include "fem/linear_algebra/blocks/block_matrix.h"
#include "fem/material.h"
#include "mesh/core/volume_mesh.h"

namespace palpate::fem {

/// Which rows of a symmetric matrix are stored in its columns.
enum class Half { both, lower };

/// For each numbered node, in order, the numbers of the nodes that share an element with it, itself included,
/// ascending; `lower`: not smaller than its own. `number` (n): an index per node, or -1 for nodes that are left out.
std::vector<std::vector<int>> neighbours(const mesh::VolumeMesh& mesh, const std::vector<int>& number, Half half);

/// The stiffness matrix of the numbered nodes; degree of freedom 3 number(i) + c is component c of node i.
///
/// Each column is summed by one thread, over the node's elements in order: the same numbers on any number of threads.
/// @throws InvalidInput for a material out of range, linear elements with nu > 0.4, an element turned inside out.
template <class Index>
Eigen::SparseMatrix<double, Eigen::ColMajor, Index> assemble(const mesh::VolumeMesh& mesh, const Materials& materials,
                                                             Dilatation dilatation, const std::vector<int>& number,
                                                             Half half);

/// The same as blocks, both halves: a third of the memory. @throws as assemble.
BlockMatrix<3, 3> assemble_blocks(const mesh::VolumeMesh& mesh, const Materials& materials, Dilatation dilatation,
                                  const std::vector<int>& number);

extern template Eigen::SparseMatrix<double, Eigen::ColMajor, int> assemble<int>(  //
    const mesh::VolumeMesh&, const Materials&, Dilatation, const std::vector<int>&, Half);
extern template Eigen::SparseMatrix<double, Eigen::ColMajor, std::int64_t> assemble<std::int64_t>(
    const mesh::VolumeMesh&, const Materials&, Dilatation, const std::vector<int>&, Half);

}  // namespace palpate::fem
