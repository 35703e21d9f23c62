#pragma once

#include "fem/linear_algebra/cholesky/lower_matrix.h"
#include "fem/linear_algebra/cholesky/supernodes.h"

namespace palpate::fem {

/// Fills `values` (structure.first_value.back()) with the factor L of K; what lies above the diagonal of a supernode's
/// block is undefined. False when a pivot is not positive.
bool factorise(const Supernodes& structure, const LowerMatrix& K, double* values);

}  // namespace palpate::fem
