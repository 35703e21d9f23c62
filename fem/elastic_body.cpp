#include "fem/elastic_body.h"

#include <fmt/format.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cassert>
#include <chrono>
#include <numeric>
#include <span>

#include "fem/elements/assembly.h"
#include "fem/solve/cholesky.h"
#include "fem/solve/restraint.h"
#include "mesh/errors.h"

namespace palpate::fem {

namespace {

double seconds_since(std::chrono::steady_clock::time_point start) {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

void validate(const ElasticBodyOptions& options) {
    if (options.threads < 1) {
        throw InvalidInput(fmt::format("threads is {}; allowed: 1 and more.", options.threads));
    }
    if (options.block < 1 || options.block > 1024) {
        throw InvalidInput(
            fmt::format("block (right-hand sides solved together) is {}; allowed: 1 to 1024.", options.block));
    }
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

}  // namespace

struct ElasticBody::Impl {
    mesh::VolumeMesh mesh;
    Material material;
    std::vector<char> held;
    ElasticBodyOptions options;
    ElasticBodyStats stats;
    std::vector<int> number;  // of each node in K, -1: held
    std::unique_ptr<Cholesky> factor;

    template <class Loads>
    Eigen::MatrixXd solve(const Loads& loads) const;
    std::vector<Eigen::Index> solving_order(const Eigen::SparseMatrix<double>& loads) const;
    std::vector<Eigen::Index> solving_order(const Eigen::MatrixXd& loads) const;
    void fill(const Eigen::SparseMatrix<double>& loads, std::span<const Eigen::Index> columns, Block& F) const;
    void fill(const Eigen::MatrixXd& loads, std::span<const Eigen::Index> columns, Block& F) const;
};

ElasticBody::ElasticBody(mesh::VolumeMesh mesh, const Material& material, const std::vector<char>& held,
                         const ElasticBodyOptions& options)
    : impl_(std::make_unique<Impl>()) {
    assert(held.size() == static_cast<std::size_t>(mesh.nodes.rows()));
    material.validate();
    validate(options);
    check_restraint(mesh, held);

    ElasticBodyStats& stats = impl_->stats;
    stats.dilatation = mesh.is_quadratic() && material.poisson >= 0.45 ? Dilatation::mean : Dilatation::full;
    arena(options).execute([&] {
        // The nodes in the order of elimination.
        auto start = std::chrono::steady_clock::now();
        std::vector<int>& number = impl_->number = number_free_nodes(held);
        Elimination elimination = analyse(neighbours(mesh, number, Half::lower), 3);
        for (int& k : number) {
            if (k >= 0) k = elimination.position[k];
        }
        const double seconds_order = seconds_since(start);

        start = std::chrono::steady_clock::now();
        const LowerMatrix K = assemble<std::int64_t>(mesh, material, stats.dilatation, number, Half::lower);
        stats.seconds_assemble = seconds_since(start);

        start = std::chrono::steady_clock::now();
        impl_->factor =
            std::make_unique<Cholesky>(std::make_shared<const Supernodes>(std::move(elimination.supernodes)), K);
        stats.seconds_factor = seconds_order + seconds_since(start);
        stats.free_dofs = static_cast<int>(K.rows());
    });
    stats.nodes = static_cast<int>(mesh.nodes.rows());
    stats.elements = static_cast<int>(mesh.tetrahedra.rows());
    stats.factor_entries = impl_->factor->entries();
    impl_->mesh = std::move(mesh);
    impl_->material = material;
    impl_->held = held;
    impl_->options = options;
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
                             Block& F) const {
    for (std::size_t j = 0; j < columns.size(); ++j) {
        for (Eigen::SparseMatrix<double>::InnerIterator entry(loads, columns[j]); entry; ++entry) {
            const Eigen::Index node = number[entry.row() / 3];
            if (node >= 0) F(3 * node + entry.row() % 3, j) = entry.value();
        }
    }
}

void ElasticBody::Impl::fill(const Eigen::MatrixXd& loads, std::span<const Eigen::Index> columns, Block& F) const {
    for (std::size_t i = 0; i < number.size(); ++i) {
        const Eigen::Index node = number[i];
        for (std::size_t j = 0; node >= 0 && j < columns.size(); ++j) {
            F.col(j).segment<3>(3 * node) = loads.col(columns[j]).segment<3>(3 * i);
        }
    }
}

template <class Loads>
Eigen::MatrixXd ElasticBody::Impl::solve(const Loads& loads) const {
    assert(loads.rows() == mesh.nodes.size());
    Eigen::MatrixXd U = Eigen::MatrixXd::Zero(loads.rows(), loads.cols());
    const std::vector<Eigen::Index> order = solving_order(loads);
    const std::size_t block = options.block, blocks = (order.size() + block - 1) / block;
    arena(options).execute([&] {
        tbb::parallel_for(std::size_t(0), blocks, [&](std::size_t b) {
            const auto columns = std::span(order).subspan(b * block, std::min(block, order.size() - b * block));
            Block X = Block::Zero(stats.free_dofs, static_cast<Eigen::Index>(columns.size()));
            fill(loads, columns, X);
            factor->solve(X);
            for (std::size_t i = 0; i < number.size(); ++i) {
                const Eigen::Index node = number[i];
                for (std::size_t j = 0; node >= 0 && j < columns.size(); ++j) {
                    U.col(columns[j]).template segment<3>(3 * i) = X.col(j).template segment<3>(3 * node);
                }
            }
        });
    });
    return U;
}

Eigen::MatrixXd ElasticBody::solve(const Eigen::SparseMatrix<double>& loads) const { return impl_->solve(loads); }
Eigen::MatrixXd ElasticBody::solve(const Eigen::MatrixXd& loads) const { return impl_->solve(loads); }

const mesh::VolumeMesh& ElasticBody::mesh() const { return impl_->mesh; }
const Material& ElasticBody::material() const { return impl_->material; }
const std::vector<char>& ElasticBody::held() const { return impl_->held; }
const ElasticBodyStats& ElasticBody::stats() const { return impl_->stats; }

}  // namespace palpate::fem
