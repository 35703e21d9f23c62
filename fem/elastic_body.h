#pragma once

#include <memory>
#include <string>
#include <vector>

#include "fem/elements/stiffness.h"
#include "fem/solver.h"

namespace palpate::fem {

struct ElasticBodyOptions {
    int threads = 1;    // for blocks of right-hand sides
    int block = 96;     // right-hand sides solved together with a factor, at most, [1, 1024]
    double memory = 0;  // that a factor may take [GB], >= 0; 0: nine tenths of what is free
    int loads = 0;      // to be solved for, >= 0: a few of a large body take less without a factor; 0: not known
    Solver solver = Solver::automatic;
    void validate() const;  // @throws InvalidInput naming option, value and bound
};

struct ElasticBodyStats {
    int nodes = 0, elements = 0, free_dofs = 0;
    double factor_entries = 0;                        // nonzeros of the Cholesky factor, made or not
    double seconds_assemble = 0, seconds_factor = 0;  // or, in place of factoring, to make the multigrid
    double seconds_analyse = 0;                       // of the latter: to order the unknowns and count the factor
    Dilatation dilatation = Dilatation::full;
    Solver solver = Solver::factor;  // that was taken
    int levels = 0;                  // of our multigrid; 0: there is none
    std::string note;                // what solves, and why, in words; empty: a factor
};

/// A linearly elastic body, held at some nodes: assembled and factored once (by supernodes, ordered by CHOLMOD), then
/// solved for many loads. Where the factor would not fit into memory, or take longer than the loads, each load is
/// solved for by conjugate gradients with multigrid instead, or PETSc's on several processes, to 1e-11 in the energy
/// norm. P2/P0 from nu = 0.45.
class ElasticBody {
public:
    /// `held`: a flag per node (n). @throws InvalidInput when nothing, or too little to stop rigid motion, is held;
    /// SolverFailure when the factorisation fails, or the factor that was asked for would not fit into memory.
    ElasticBody(mesh::VolumeMesh mesh, const Material& material, const std::vector<char>& held,
                const ElasticBodyOptions& options = {});
    /// The same of several materials. P2/P0 from nu = 0.45 in any of them.
    ElasticBody(mesh::VolumeMesh mesh, Materials materials, const std::vector<char>& held,
                const ElasticBodyOptions& options = {});
    ~ElasticBody();
    ElasticBody(ElasticBody&&) noexcept;

    /// Displacements U of K U = F (3n x p) [mm], zero at the held nodes; F (3n x p) [N]. Safe from several threads.
    /// @throws SolverFailure when conjugate gradients do not converge.
    Eigen::MatrixXd solve(const Eigen::SparseMatrix<double>& loads) const;
    Eigen::MatrixXd solve(const Eigen::MatrixXd& loads) const;

    const mesh::VolumeMesh& mesh() const;
    const Materials& materials() const;
    const std::vector<char>& held() const;
    const ElasticBodyStats& stats() const;
    /// Of conjugate gradients, the most that loads took so far; 0 with a factor.
    int most_iterations() const;

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace palpate::fem
