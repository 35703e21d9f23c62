#include "fem/large_deformation/solve/tangent_solver.h"

#include <algorithm>

#include "fem/distributed/distributed_stiffness.h"
#include "fem/linear_algebra/conjugate_gradients.h"
#include "mesh/errors.h"

namespace palpate::fem {
namespace {

constexpr Eigen::Index read_together = 8;  // loads whose conjugate gradients pass through the matrix together

// Of Newton steps: the net force falls by about as much, and seldom by more where the forces bend. [Dembo, Eisenstat &
// Steihaug 1982]
constexpr double step_tolerance = 1e-3;

ConjugateGradientsOptions options_of(Accuracy accuracy) {
    if (accuracy == Accuracy::answers) return {};
    return {.tolerance = step_tolerance, .truncated = true};
}

/// Makes what solves in place of what solved before; false where the matrix is found not to be positive definite.
template <class Made, class Make>
bool renew(std::unique_ptr<Made>& made, Make&& make) {
    made.reset();  // two would take twice the memory
    try {
        made = make();
    } catch (const SolverFailure&) {
        return false;
    }
    return true;
}

class ByFactor final : public TangentSolver {
public:
    explicit ByFactor(std::shared_ptr<const Supernodes> structure) : cholesky_(std::move(structure)) {}
    bool take(const LowerMatrix& K) override { return cholesky_.factor(K); }
    void solve(MultiVector& X) const override { cholesky_.solve(X); }
    double gigabytes() const override { return 8e-9 * cholesky_.entries(); }

private:
    Cholesky cholesky_;
};

class ByMultigrid final : public TangentSolver {
public:
    ByMultigrid(const Points& positions, Accuracy accuracy)
        : modes_(rigid_modes(positions)), options_(options_of(accuracy)) {}
    bool take(const LowerMatrix& K) override {
        return renew(multigrid_, [&] { return std::make_unique<Multigrid>(symmetric_blocks(K), modes_); });
    }
    void solve(MultiVector& X) const override {
        for (Eigen::Index first = 0; first < X.cols(); first += read_together) {
            const Eigen::Index count = std::min(read_together, X.cols() - first);
            MultiVector some = X.middleCols(first, count);
            conjugate_gradients(*multigrid_, some, options_);
            X.middleCols(first, count) = some;
        }
    }
    double gigabytes() const override {
        // In double precision the matrix, in single precision those of all levels and as much in prolongators.
        return 9 * 8e-9 * static_cast<double>(multigrid_->matrix().blocks()) * (1 + multigrid_->complexity());
    }

private:
    RigidModes modes_;
    ConjugateGradientsOptions options_;
    std::unique_ptr<Multigrid> multigrid_;
};

class ByProcesses final : public TangentSolver {
public:
    ByProcesses(const Points& positions, Accuracy accuracy) : positions_(positions), options_(options_of(accuracy)) {}
    bool take(const LowerMatrix& K) override {
        return renew(shared_, [&] { return std::make_unique<DistributedStiffness>(symmetric_blocks(K), positions_); });
    }
    void solve(MultiVector& X) const override { shared_->solve(X, options_); }
    double gigabytes() const override { return 0; }  // the other processes'

private:
    Points positions_;
    ConjugateGradientsOptions options_;
    std::unique_ptr<DistributedStiffness> shared_;
};

}  // namespace

std::unique_ptr<TangentSolver> make_tangent_solver(const EliminationOrder& order, Accuracy accuracy) {
    if (order.supernodes) return std::make_unique<ByFactor>(order.supernodes);
    if (order.solver == Solver::petsc) return std::make_unique<ByProcesses>(order.positions, accuracy);
    return std::make_unique<ByMultigrid>(order.positions, accuracy);
}

}  // namespace palpate::fem
