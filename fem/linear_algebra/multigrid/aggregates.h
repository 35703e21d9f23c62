#pragma once

#include "fem/linear_algebra/blocks/block_matrix.h"

namespace palpate::fem {

/// Nodes that become one on the next coarser level.
struct Aggregates {
    std::vector<int> of_node;  // the aggregate of each node
    int count = 0;
};

/// Each aggregate is a node with those it is strongly connected to, all of them free so far; what is left over joins
/// the aggregate it is most strongly connected to. Nodes i and j are strongly connected where
///   |A_ij| >= threshold sqrt(|A_ii| |A_jj|),
/// with the Frobenius norms of the blocks. [Vanek, Mandel & Brezina 1996, algorithm 5.1]
template <int b>
Aggregates aggregate(const BlockMatrix<b, b>& A, double threshold);

extern template Aggregates aggregate(const BlockMatrix<3, 3>&, double);
extern template Aggregates aggregate(const BlockMatrix<6, 6>&, double);

}  // namespace palpate::fem
