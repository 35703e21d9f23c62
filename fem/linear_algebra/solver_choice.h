#pragma once

#include <string>
#include <vector>

#include "fem/linear_algebra/cholesky/supernodes.h"

namespace palpate::fem {

/// What factoring takes.
struct FactorCost {
    double nodes = 0;             // that are free, three unknowns each
    double entries = 0;           // of the factor
    double matrix_gigabytes = 0;  // the lower half of the matrix, values and rows [GB]
    double products = 0;          // multiplications

    double gigabytes() const { return 8e-9 * entries + matrix_gigabytes; }
    double seconds() const;  // on two cores
    /// Of the same body with so many nodes, by nested dissection in space: entries grow as nodes^(4/3), products as
    /// nodes^2 [George 1973; Lipton, Rose, Tarjan 1979].
    FactorCost with_nodes(double other) const;
};
/// `structure`: of the factor; `lower`: for each node its neighbours with an index not smaller than its own.
FactorCost cost_of_factor(const Supernodes& structure, const std::vector<std::vector<int>>& lower);

/// What conjugate gradients with multigrid take [s], on two cores: to make it, and for the load cases.
double seconds_without_factor(double nodes, int loads);
/// What our multigrid takes [GB], the matrix included.
double multigrid_gigabytes(double nodes);

/// Would they be done with the load cases in less than 0.4 of the time of a factorisation? False for 0 loads, which
/// are not known.
bool is_faster_without_factor(const FactorCost& cost, int loads);

/// What a factor may take, nine tenths of what is free [GB]: the rest is for vectors, and for other programs.
double usable_memory();

/// What is said where a factor that was asked for does not fit.
std::string no_room_for_factor(std::ptrdiff_t unknowns, double needed, double allowed);

}  // namespace palpate::fem
