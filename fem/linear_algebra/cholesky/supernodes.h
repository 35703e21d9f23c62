#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace palpate::fem {

/// The structure of a Cholesky factor whose columns are grouped: the columns of a supernode share their rows below the
/// diagonal, so that each group is stored as one dense block, (rows x columns) by columns.
struct Supernodes {
    std::vector<int> first_column;          // of each supernode (count + 1)
    std::vector<std::int64_t> first_row;    // of each supernode in `rows` (count + 1)
    std::vector<std::int64_t> first_value;  // of each supernode's block in the factor (count + 1)
    std::vector<int> rows;                  // ascending; a supernode's own columns come first
    std::vector<int> parent;                // the supernode of the first row below the own columns, or -1 (count)

    int count() const { return static_cast<int>(parent.size()); }
    int size() const { return first_column.back(); }
    int columns(int s) const { return first_column[s + 1] - first_column[s]; }
    int height(int s) const { return static_cast<int>(first_row[s + 1] - first_row[s]); }
    std::span<const int> rows_of(int s) const { return std::span(rows).subspan(first_row[s], height(s)); }
    std::span<const int> rows_below(int s) const { return rows_of(s).subspan(columns(s)); }
};

/// How to eliminate the unknowns of a graph.
struct Elimination {
    std::vector<int> position;  // of each node in the order of elimination
    Supernodes supernodes;      // of the unknowns in that order, `unknowns_per_node` consecutive ones for each node
};

/// An order with little fill, by nested dissection (METIS) or minimum degree (AMD), whichever fills less.
///
/// The nodes are ordered, not their unknowns: the same fill at a fraction of the time. `lower`: for each node its
/// neighbours with an index not smaller than its own, ascending.
/// @throws SolverFailure when memory does not suffice.
Elimination analyse(const std::vector<std::vector<int>>& lower, int unknowns_per_node);

}  // namespace palpate::fem
