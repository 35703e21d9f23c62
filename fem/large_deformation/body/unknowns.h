#pragma once

#include <memory>
#include <vector>

#include "fem/large_deformation/elements/element_kernel.h"
#include "fem/linear_algebra/cholesky/cholesky.h"
#include "fem/linear_algebra/cholesky/lower_matrix.h"
#include "fem/solver.h"
#include "mesh/core/volume_mesh.h"

namespace palpate::fem {

/// Sets of nodes of which each is coupled to all others of its set.
using JoinedNodes = std::vector<std::vector<int>>;

/// Nodes that may move, numbered; the lower half of the tangent's matrix over their degrees of freedom 3 number + c,
/// and where the elements' tangents go in it.
class Unknowns {
public:
    /// `number` (n): an index per node, -1: left out. `joined`: sets of nodes that are coupled beyond elements.
    Unknowns(const mesh::VolumeMesh& mesh, std::vector<int> number, const JoinedNodes& joined = {});

    int size() const { return static_cast<int>(zero_.rows()); }
    const std::vector<int>& number() const { return number_; }
    const LowerMatrix& zero() const { return zero_; }  // the matrix, all entries zero

    /// Adds an element's tangent; of diagonal blocks both halves are filled.
    void add(int element, const ElementTangent& tangent, LowerMatrix& K) const;
    /// Adds a symmetric block to the diagonal at a node, unless it is left out.
    void add(int node, const Mat3& block, LowerMatrix& K) const;
    /// Adds the block at (a, b) of a symmetric matrix, whose transpose is that at (b, a), unless one is left out.
    /// @pre an element or a joined set holds both; of two different nodes one order is added.
    void add(int a, int b, const Mat3& block, LowerMatrix& K) const;

    Eigen::VectorXd gather(const Eigen::VectorXd& u) const;   // (3n) to (size)
    Eigen::VectorXd scatter(const Eigen::VectorXd& x) const;  // back, zero at nodes that are left out

private:
    Tetrahedra tetrahedra_;
    std::vector<int> number_;
    LowerMatrix zero_;
    std::vector<std::int64_t> place_;  // of each element's node pairs i <= j in the matrix' values, -1: none
};

/// Unknowns in an order with little fill, and the structure of their factor; or along a curve through the body, where
/// iterations solve.
struct EliminationOrder {
    Unknowns unknowns;
    std::shared_ptr<const Supernodes> supernodes;  // null: there is no factor
    Solver solver = Solver::factor;                // what solves
    Points positions{};                            // of the unknowns' nodes, where iterations solve
};

/// `solver`, automatic: a factor if it fits into nine tenths of the free memory. @throws SolverFailure when memory does
/// not suffice for the factor that is asked for.
EliminationOrder elimination_order(const mesh::VolumeMesh& mesh, const std::vector<char>& held,
                                   const JoinedNodes& joined = {}, Solver solver = Solver::automatic);

}  // namespace palpate::fem
