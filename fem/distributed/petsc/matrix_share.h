#pragma once

#include <string>

#include "fem/distributed/petsc/messages.h"
#include "fem/distributed/petsc/petsc_handles.h"

namespace palpate::fem {

/// One process's share of a body's stiffness matrix, and of the solver. All processes make one together, and solve
/// together; loads and displacements are the leader's.
class MatrixShare {
public:
    /// @throws SolverFailure, InvalidInput on the leader, whatever process it comes from.
    explicit MatrixShare(const BodyPart& part);
    explicit MatrixShare(const MatrixRows& rows);

    /// x <- K^-1 x of all processes' nodes (3 free nodes); on processes but the leader x is not read. @return
    /// iterations. @throws SolverFailure on all processes, where conjugate gradients do not converge, unless they are
    /// truncated.
    int solve(double* x, const ConjugateGradientsOptions& how);
    std::string description() const;

private:
    struct RowLengths;
    void make_matrix(int own, const RowLengths& lengths);
    void end_assembly();
    void make_solver(const Eigen::Ref<const Points>& positions);
    double solve_for_load(const ConjugateGradientsOptions& how, int& iterations, std::string& reason);

    MatrixHandle K_;
    SolverHandle solver_;
    VectorHandle load_, displacement_, residual_, of_leader_;
    ScatterHandle to_leader_;
};

}  // namespace palpate::fem
