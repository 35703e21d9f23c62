#pragma once

#include <memory>
#include <string>
#include <vector>

#include "fem/elements/dilatation.h"
#include "fem/linear_algebra/conjugate_gradients.h"
#include "fem/material.h"
#include "mesh/core/volume_mesh.h"

namespace palpate::fem {

/// The stiffness matrix of a body over all processes: each assembles and holds the rows of a part of the body, and
/// conjugate gradients with PETSc's algebraic multigrid (GAMG, with the body's rigid motions as near-null space) solve
/// for loads. PETSC_OPTIONS in the environment chooses another way, as in all programs with PETSc, say
/// "-pc_type hypre" or "-ksp_type preonly -pc_type cholesky -pc_factor_mat_solver_type mumps".
///
/// Of the leading process alone: the others follow. Safe from several threads, one of which solves at a time.
class DistributedStiffness {
public:
    /// Assembled by the processes, each a part of the body. Answers hang on the number of processes, in digits beyond
    /// the tolerance. @throws InvalidInput as `assemble`, or where this program was built without PETSc; SolverFailure
    /// with PETSc's message.
    DistributedStiffness(const mesh::VolumeMesh& mesh, const Materials& materials, Dilatation dilatation,
                         const std::vector<char>& held);
    /// A symmetric matrix that is here already, of nodes at `positions` (rows x 3): each process takes some of its
    /// rows.
    DistributedStiffness(const BlockMatrix<3, 3>& K, const Points& positions);
    ~DistributedStiffness();

    /// Of each node of the mesh in the matrix, -1: held. Nodes of a part follow each other.
    const std::vector<int>& number() const;
    /// X <- K^-1 X, one load after the other; X (3 free nodes x p); as `conjugate_gradients`. @return iterations of the
    /// load that took most. @throws SolverFailure where conjugate gradients do not converge, unless they are truncated.
    int solve(MultiVector& X, const ConjugateGradientsOptions& options = {});
    /// What solves, in words.
    std::string description() const;

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace palpate::fem
