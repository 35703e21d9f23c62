#include "fem/elastic_body.h"

#include <fmt/format.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <cassert>
#include <chrono>
#include <numeric>
#include <span>
#include <utility>

#include "fem/distributed/distributed_stiffness.h"
#include "fem/distributed/processes.h"
#include "fem/elements/assembly.h"
#include "fem/elements/restraint.h"
#include "fem/linear_algebra/cholesky/cholesky.h"
#include "fem/linear_algebra/conjugate_gradients.h"
#include "fem/linear_algebra/memory/huge_pages.h"
#include "fem/linear_algebra/multigrid/morton.h"
#include "fem/linear_algebra/solver_choice.h"
#include "mesh/errors.h"

namespace palpate::fem {

namespace {

constexpr std::size_t together = 8;  // loads whose conjugate gradients read the matrix together

double seconds_since(std::chrono::steady_clock::time_point start) {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// As many threads as asked for, but no more than there are: TBB would complain aloud.
tbb::task_arena arena(const ElasticBodyOptions& options) {
    const auto available = tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism);
    return tbb::task_arena(std::min(options.threads, static_cast<int>(available)));
}

/// Nodes that may move, numbered in their order; -1: held.
std::vector<int> number_free_nodes(const std::vector<char>& held) {
    std::vector<int> number(held.size());
    int count = 0;
    for (std::size_t i = 0; i < held.size(); ++i) number[i] = held[i] ? -1 : count++;
    return number;
}

Points numbered_positions(const mesh::VolumeMesh& mesh, const std::vector<int>& number) {
    Points positions(std::ranges::count_if(number, [](int k) { return k >= 0; }), 3);
    for (std::size_t i = 0; i < number.size(); ++i) {
        if (number[i] >= 0) positions.row(number[i]) = mesh.nodes.row(static_cast<Eigen::Index>(i));
    }
    return positions;
}

}  // namespace

struct ElasticBody::Impl {
    mesh::VolumeMesh mesh;
    Materials materials;
    std::vector<char> held;
    ElasticBodyOptions options;
    ElasticBodyStats stats;
    std::vector<int> number;  // of each node in K, -1: held
    std::unique_ptr<Cholesky> factor;
    std::unique_ptr<Multigrid> multigrid;               // where there is no factor
    std::unique_ptr<DistributedStiffness> distributed;  // likewise
    mutable std::atomic<int> most_iterations = 0;

    void prepare();
    void make_factor(Elimination elimination);
    void make_multigrid();
    void distribute();
    void solve_together(MultiVector& X) const;
    template <class Loads>
    void solve_some(const Loads& loads, std::span<const Eigen::Index> columns, MultiVector& X,
                    Eigen::MatrixXd& U) const;
    void take(const MultiVector& X, std::span<const Eigen::Index> columns, Eigen::MatrixXd& U) const;
    std::size_t block_of(std::size_t loads) const;
    template <class Loads>
    Eigen::MatrixXd solve(const Loads& loads) const;
    std::vector<Eigen::Index> solving_order(const Eigen::SparseMatrix<double>& loads) const;
    std::vector<Eigen::Index> solving_order(const Eigen::MatrixXd& loads) const;
    void fill(const Eigen::SparseMatrix<double>& loads, std::span<const Eigen::Index> columns, MultiVector& F) const;
    void fill(const Eigen::MatrixXd& loads, std::span<const Eigen::Index> columns, MultiVector& F) const;
};

ElasticBody::ElasticBody(mesh::VolumeMesh mesh, const Material& material, const std::vector<char>& held,
                         const ElasticBodyOptions& options)
    : ElasticBody(std::move(mesh), Materials{.body = material}, held, options) {}

ElasticBody::ElasticBody(mesh::VolumeMesh mesh, Materials materials, const std::vector<char>& held,
                         const ElasticBodyOptions& options)
    : impl_(std::make_unique<Impl>()) {
    assert(held.size() == static_cast<std::size_t>(mesh.nodes.rows()));
    assert(materials.of_element.empty() || std::ssize(materials.of_element) == mesh.tetrahedra.rows());
    materials.validate();
    options.validate();
    check_restraint(mesh, held);
    ElasticBodyStats& stats = impl_->stats;
    constexpr double near_incompressible = 0.45;
    if (mesh.is_quadratic() && materials.most_poisson() >= near_incompressible) stats.dilatation = Dilatation::mean;
    stats.nodes = static_cast<int>(mesh.nodes.rows());
    stats.elements = static_cast<int>(mesh.tetrahedra.rows());
    impl_->mesh = std::move(mesh);
    impl_->materials = std::move(materials);
    impl_->held = held;
    impl_->options = options;
    arena(options).execute([&] { impl_->prepare(); });
}

/// As the options ask for; else a factor where memory holds it and loads are worth it.
void ElasticBody::Impl::prepare() {
    const auto start = std::chrono::steady_clock::now();
    number = number_free_nodes(held);
    stats.free_dofs = 3 * static_cast<int>(std::ranges::count_if(number, [](int k) { return k >= 0; }));
    if (options.solver == Solver::petsc) return distribute();
    if (options.solver == Solver::multigrid) return make_multigrid();
    auto lower = neighbours(mesh, number, Half::lower);
    Elimination elimination = analyse(lower, 3);
    const FactorCost cost = cost_of_factor(elimination.supernodes, std::exchange(lower, {}));
    const double needed = cost.gigabytes();
    stats.factor_entries = cost.entries;
    stats.seconds_analyse = stats.seconds_factor = seconds_since(start);

    const double allowed = options.memory > 0 ? options.memory : usable_memory();
    const char* const instead = Processes::count() > 1 ? "PETSc" : "conjugate gradients with multigrid";
    if (needed > allowed) {
        stats.note =
            fmt::format("A factor of the stiffness matrix ({} unknowns) would take {:.3g} GB of {:.3g} GB: {} instead.",
                        stats.free_dofs, needed, allowed, instead);
        if (options.solver == Solver::factor) throw SolverFailure(no_room_for_factor(stats.free_dofs, needed, allowed));
    } else if (options.solver == Solver::automatic && is_faster_without_factor(cost, options.loads)) {
        stats.note = fmt::format(
            "A factor of the stiffness matrix ({} unknowns, {:.3g} GB) would take longer than {} load(s) without it: "
            "{} instead.",
            stats.free_dofs, needed, options.loads, instead);
    } else {
        return make_factor(std::move(elimination));
    }
    elimination = {};
    if (Processes::count() > 1) return distribute();
    make_multigrid();
}

void ElasticBody::Impl::distribute() {
    const auto start = std::chrono::steady_clock::now();
    distributed = std::make_unique<DistributedStiffness>(mesh, materials, stats.dilatation, held);
    number = distributed->number();
    stats.solver = Solver::petsc;
    stats.seconds_factor += seconds_since(start);
    stats.note += fmt::format("{}{} unknowns are solved for by {}.", stats.note.empty() ? "" : " ", stats.free_dofs,
                              distributed->description());
}

void ElasticBody::Impl::make_factor(Elimination elimination) {
    // The nodes in the order of elimination.
    for (int& k : number) {
        if (k >= 0) k = elimination.position[k];
    }
    auto start = std::chrono::steady_clock::now();
    const LowerMatrix K = assemble<std::int64_t>(mesh, materials, stats.dilatation, number, Half::lower);
    stats.seconds_assemble = seconds_since(start);
    start = std::chrono::steady_clock::now();
    factor = std::make_unique<Cholesky>(std::make_shared<const Supernodes>(std::move(elimination.supernodes)), K);
    stats.seconds_factor += seconds_since(start);
}

void ElasticBody::Impl::make_multigrid() {
    auto start = std::chrono::steady_clock::now();
    Points positions = numbered_positions(mesh, number);
    const std::vector<int> order = morton_order(positions);
    std::vector<int> place(order.size());
    for (std::size_t k = 0; k < order.size(); ++k) place[order[k]] = static_cast<int>(k);
    for (int& k : number) {
        if (k >= 0) k = place[k];
    }
    positions = Points(positions(order, Eigen::all));

    BlockMatrix<3, 3> K = assemble_blocks(mesh, materials, stats.dilatation, number);
    stats.seconds_assemble = seconds_since(start);
    start = std::chrono::steady_clock::now();
    multigrid = std::make_unique<Multigrid>(std::move(K), rigid_modes(positions));
    stats.solver = Solver::multigrid;
    stats.seconds_factor += seconds_since(start);
    stats.levels = multigrid->levels();
}

ElasticBody::~ElasticBody() = default;
ElasticBody::ElasticBody(ElasticBody&&) noexcept = default;

/// Sparse loads that enter the elimination tree near each other share a block, which then passes over most of the tree.
std::vector<Eigen::Index> ElasticBody::Impl::solving_order(const Eigen::SparseMatrix<double>& loads) const {
    std::vector<int> entrance(loads.cols(), stats.free_dofs);
    for (Eigen::Index j = 0; j < loads.cols(); ++j) {
        for (Eigen::SparseMatrix<double>::InnerIterator entry(loads, j); entry; ++entry) {
            if (number[entry.row() / 3] >= 0) entrance[j] = std::min(entrance[j], number[entry.row() / 3]);
        }
    }
    std::vector<Eigen::Index> order(loads.cols());
    std::iota(order.begin(), order.end(), 0);
    std::ranges::stable_sort(order, {}, [&](Eigen::Index j) { return entrance[j]; });
    return order;
}

std::vector<Eigen::Index> ElasticBody::Impl::solving_order(const Eigen::MatrixXd& loads) const {
    std::vector<Eigen::Index> order(loads.cols());
    std::iota(order.begin(), order.end(), 0);
    return order;
}

void ElasticBody::Impl::fill(const Eigen::SparseMatrix<double>& loads, std::span<const Eigen::Index> columns,
                             MultiVector& F) const {
    for (std::size_t j = 0; j < columns.size(); ++j) {
        for (Eigen::SparseMatrix<double>::InnerIterator entry(loads, columns[j]); entry; ++entry) {
            const Eigen::Index node = number[entry.row() / 3];
            if (node >= 0) F(3 * node + entry.row() % 3, j) = entry.value();
        }
    }
}

void ElasticBody::Impl::fill(const Eigen::MatrixXd& loads, std::span<const Eigen::Index> columns,
                             MultiVector& F) const {
    for (std::size_t i = 0; i < number.size(); ++i) {
        const Eigen::Index node = number[i];
        for (std::size_t j = 0; node >= 0 && j < columns.size(); ++j) {
            F.col(j).segment<3>(3 * node) = loads.col(columns[j]).segment<3>(3 * i);
        }
    }
}

void ElasticBody::Impl::solve_together(MultiVector& X) const {
    if (factor) return factor->solve(X);
    const int iterations = distributed ? distributed->solve(X) : conjugate_gradients(*multigrid, X);
    int most = most_iterations;
    while (iterations > most && !most_iterations.compare_exchange_weak(most, iterations)) {
    }
}

/// Columns of the displacements, all of their entries.
void ElasticBody::Impl::take(const MultiVector& X, std::span<const Eigen::Index> columns, Eigen::MatrixXd& U) const {
    constexpr std::size_t chunk = 64;  // nodes, whose rows of X stay in the cache while they go to their columns
    for (std::size_t begin = 0; begin < number.size(); begin += chunk) {
        const std::size_t end = std::min(begin + chunk, number.size());
        for (std::size_t j = 0; j < columns.size(); ++j) {
            double* u = U.col(columns[j]).data();
            for (std::size_t i = begin; i < end; ++i) {
                for (int a = 0; a < 3; ++a) u[3 * i + a] = number[i] < 0 ? 0.0 : X(3 * number[i] + a, j);
            }
        }
    }
}

template <class Loads>
void ElasticBody::Impl::solve_some(const Loads& loads, std::span<const Eigen::Index> columns, MultiVector& X,
                                   Eigen::MatrixXd& U) const {
    // Whole vectors of loads, so that each entry of the matrix is read once; those that are zero are done at once.
    const std::size_t width = factor || columns.size() < 3 ? columns.size() : together;
    X.setZero(stats.free_dofs, static_cast<Eigen::Index>(width));
    fill(loads, columns, X);
    solve_together(X);
    take(X, columns, U);
}

/// Loads that are solved for together: as many as serve, but some blocks for the threads to share. That does not depend
/// on how many threads there are, nor do the numbers.
std::size_t ElasticBody::Impl::block_of(std::size_t loads) const {
    if (!factor) return together;
    const auto largest = static_cast<std::size_t>(options.block);
    constexpr std::size_t shares = 4, least = 32;
    const std::size_t block = std::min(largest, std::max(least, (loads + shares - 1) / shares));
    const std::size_t blocks = (loads + block - 1) / block;
    return (loads + blocks - 1) / std::max<std::size_t>(blocks, 1);
}

template <class Loads>
Eigen::MatrixXd ElasticBody::Impl::solve(const Loads& loads) const {
    assert(loads.rows() == mesh.nodes.size());
    Eigen::MatrixXd U(loads.rows(), loads.cols());
    use_huge_pages(U.data(), sizeof(double) * U.size());
    const std::vector<Eigen::Index> order = solving_order(loads);
    const std::size_t block = block_of(order.size());
    tbb::enumerable_thread_specific<MultiVector> X;  // kept from block to block: fresh memory costs
    const auto solve_block = [&](std::size_t begin) {
        const std::size_t end = std::min(begin + block, order.size());
        solve_some(loads, std::span(order).subspan(begin, end - begin), X.local(), U);
    };
    arena(options).execute([&] {
        if (factor) {
            tbb::parallel_for(std::size_t(0), order.size(), block, solve_block, tbb::simple_partitioner());
        } else {  // threads work on rows
            for (std::size_t begin = 0; begin < order.size(); begin += block) solve_block(begin);
        }
    });
    return U;
}

Eigen::MatrixXd ElasticBody::solve(const Eigen::SparseMatrix<double>& loads) const { return impl_->solve(loads); }
Eigen::MatrixXd ElasticBody::solve(const Eigen::MatrixXd& loads) const { return impl_->solve(loads); }

const mesh::VolumeMesh& ElasticBody::mesh() const { return impl_->mesh; }
const Materials& ElasticBody::materials() const { return impl_->materials; }
const std::vector<char>& ElasticBody::held() const { return impl_->held; }
const ElasticBodyStats& ElasticBody::stats() const { return impl_->stats; }
int ElasticBody::most_iterations() const { return impl_->most_iterations; }

}  // namespace palpate::fem
