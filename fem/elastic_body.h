#pragma once

#include <memory>
#include <vector>

#include "fem/stiffness.h"

namespace palpate::fem {

struct ElasticBodyOptions {
    int threads = 1;  // for blocks of right-hand sides
    int block = 64;   // right-hand sides solved together, [1, 1024]
};

struct ElasticBodyStats {
    int nodes = 0, elements = 0, free_dofs = 0;
    double factor_entries = 0;  // nonzeros of the Cholesky factor
    double seconds_assemble = 0, seconds_factor = 0;
    Dilatation dilatation = Dilatation::full;
};

/// A linearly elastic body, held at some nodes: assembled and factored once (CHOLMOD, supernodal), then solved
/// for many loads. P2/P0 from nu = 0.45.
class ElasticBody {
public:
    /// `held`: a flag per node (n). @throws InvalidInput when nothing, or too little to stop rigid motion, is held;
    /// SolverFailure when the factorisation fails.
    ElasticBody(mesh::VolumeMesh mesh, const Material& material, const std::vector<char>& held,
                const ElasticBodyOptions& options = {});
    ~ElasticBody();
    ElasticBody(ElasticBody&&) noexcept;

    /// Displacements U of K U = F (3n x p) [mm], zero at the held nodes; F (3n x p) [N]. Safe from several threads.
    Eigen::MatrixXd solve(const Eigen::SparseMatrix<double>& loads) const;
    Eigen::MatrixXd solve(const Eigen::MatrixXd& loads) const;

    const mesh::VolumeMesh& mesh() const;
    const Material& material() const;
    const std::vector<char>& held() const;
    const ElasticBodyStats& stats() const;

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace palpate::fem
