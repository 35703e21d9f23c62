#pragma once

#include <string>
#include <vector>

#include "fem/linear_algebra/cholesky/supernodes.h"

namespace palpate::fem {

/// Would conjugate gradients with multigrid solve the load cases in less than 0.4 of the time of a factorisation?
/// `structure`: of the factor; three unknowns a node. False for 0 loads, which are not known.
bool is_faster_without_factor(const Supernodes& structure, int loads);

/// What factoring takes: the factor, and the lower half of the matrix, values and rows [GB]. `lower`: for each node its
/// neighbours with an index not smaller than its own.
double factor_gigabytes(const Supernodes& structure, const std::vector<std::vector<int>>& lower);

/// What a factor may take, nine tenths of what is free [GB]: the rest is for vectors, and for other programs.
double usable_memory();

/// What is said where a factor that was asked for does not fit.
std::string no_room_for_factor(std::ptrdiff_t unknowns, double needed, double allowed);

}  // namespace palpate::fem
