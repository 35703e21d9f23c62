#pragma once

#include <cstddef>
#include <vector>

#include "mesh/core/volume_mesh.h"

namespace palpate::fem {

/// Gradients of all shape functions of all elements, weighted so that integrals become sums of products.
struct ElementGradients {
    /// Rows g_q of sqrt(w_q det J) dN_i/dx_a at 3 i + a: 1 for each linear element, 4 for a straight quadratic
    /// one, 14 for a curved one.
    std::vector<double> rows;            // (rows x 3 nodes)
    std::vector<std::size_t> first_row;  // of each element (m + 1)
    /// Integral of dN_i/dx_a over the element, over the square root of its volume, at 3 i + a.
    std::vector<double> means;  // (m x 3 nodes)
};

/// @throws InvalidInput naming an element that is turned inside out.
ElementGradients element_gradients(const mesh::VolumeMesh& mesh);

}  // namespace palpate::fem
