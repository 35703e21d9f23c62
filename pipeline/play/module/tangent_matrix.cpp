// The module has no supernodes, as it has no BLAS: blocks, however many.

#include "skeleton/statics/matrices/tangent_matrix.h"

namespace palpate::skeleton {

std::unique_ptr<TangentMatrix> make_tangent_matrix(int n, const std::vector<std::array<int, 2>>& couplings) {
    return make_matrix_of_few_blocks(n, couplings);
}

}  // namespace palpate::skeleton
