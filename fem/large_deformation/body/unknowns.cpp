#include "fem/large_deformation/body/unknowns.h"

#include <tbb/task_arena.h>

#include <algorithm>

#include "fem/distributed/processes.h"
#include "fem/elements/assembly.h"
#include "fem/linear_algebra/multigrid/morton.h"
#include "fem/linear_algebra/solver_choice.h"
#include "mesh/errors.h"

namespace palpate::fem {

namespace {

constexpr int pairs = element_nodes * (element_nodes + 1) / 2;

/// A thread that waits for the others here takes up none of the caller's work, which may itself wait for this.
std::vector<std::vector<int>> lower_neighbours(const mesh::VolumeMesh& mesh, const std::vector<int>& number,
                                               const JoinedNodes& joined) {
    auto rows = tbb::this_task_arena::isolate([&] { return neighbours(mesh, number, Half::lower); });
    for (const std::vector<int>& nodes : joined) {
        for (const int a : nodes) {
            if (number[a] < 0) continue;
            std::vector<int>& own = rows[number[a]];
            for (const int b : nodes)
                if (number[b] >= number[a]) own.push_back(number[b]);
            std::ranges::sort(own);
            own.erase(std::unique(own.begin(), own.end()), own.end());
        }
    }
    return rows;
}

}  // namespace

Unknowns::Unknowns(const mesh::VolumeMesh& mesh, std::vector<int> number, const JoinedNodes& joined)
    : tetrahedra_(mesh.tetrahedra), number_(std::move(number)) {
    // Pattern: the three columns of a node hold three rows for each neighbour.
    const auto rows = lower_neighbours(mesh, number_, joined);
    const auto size = static_cast<Eigen::Index>(3 * rows.size());
    zero_.resize(size, size);
    std::int64_t* start = zero_.outerIndexPtr();
    for (Eigen::Index k = 0; k < size; ++k) start[k + 1] = start[k] + static_cast<std::int64_t>(3 * rows[k / 3].size());
    zero_.resizeNonZeros(start[size]);
    std::fill_n(zero_.valuePtr(), start[size], 0.0);
    std::int64_t* row = zero_.innerIndexPtr();
    for (Eigen::Index k = 0; k < size; ++k) {
        for (const int other : rows[k / 3]) {
            for (int c = 0; c < 3; ++c) *row++ = std::int64_t(3) * other + c;
        }
    }

    // The first entry of each pair's block, in the columns of the node with the smaller number.
    place_.reserve(pairs * tetrahedra_.rows());
    for (Eigen::Index e = 0; e < tetrahedra_.rows(); ++e) {
        for (int i = 0; i < element_nodes; ++i) {
            for (int j = i; j < element_nodes; ++j) {
                const auto [low, high] = std::minmax(number_[tetrahedra_(e, i)], number_[tetrahedra_(e, j)]);
                if (low < 0) {
                    place_.push_back(-1);
                    continue;
                }
                const auto at = std::ranges::lower_bound(rows[low], high) - rows[low].begin();
                place_.push_back(start[std::int64_t(3) * low] + 3 * at);
            }
        }
    }
}

void Unknowns::add(int element, const ElementTangent& tangent, LowerMatrix& K) const {
    const std::int64_t* start = K.outerIndexPtr();
    const std::int64_t* place = &place_[static_cast<std::size_t>(element) * pairs];
    std::array<int, element_nodes> number{};
    for (int i = 0; i < element_nodes; ++i) number[i] = number_[tetrahedra_(element, i)];
    for (int i = 0; i < element_nodes; ++i) {
        for (int j = i; j < element_nodes; ++j, ++place) {
            if (*place < 0) continue;
            const bool ascending = number[i] <= number[j];
            const int column = ascending ? i : j, row = ascending ? j : i;
            const std::int64_t stride = start[3 * number[column] + 1] - start[3 * number[column]];
            double* block = K.valuePtr() + *place;
            for (int c = 0; c < 3; ++c) {
                for (int d = 0; d < 3; ++d) block[c * stride + d] += tangent(column, c, row, d);
            }
        }
    }
}

void Unknowns::add(int node, const Mat3& block, LowerMatrix& K) const {
    if (number_[node] < 0) return;
    // A node is its own first neighbour.
    for (int c = 0; c < 3; ++c) {
        double* column = K.valuePtr() + K.outerIndexPtr()[3 * number_[node] + c];
        for (int d = 0; d < 3; ++d) column[d] += block(d, c);
    }
}

void Unknowns::add(int a, int b, const Mat3& block, LowerMatrix& K) const {
    if (number_[a] < 0 || number_[b] < 0) return;
    const bool ascending = number_[a] <= number_[b];
    const int low = ascending ? number_[a] : number_[b], high = ascending ? number_[b] : number_[a];
    const std::int64_t* start = K.outerIndexPtr() + std::int64_t(3) * low;
    const auto at =
        std::lower_bound(K.innerIndexPtr() + start[0], K.innerIndexPtr() + start[1], std::int64_t(3) * high) -
        (K.innerIndexPtr() + start[0]);
    for (int c = 0; c < 3; ++c) {
        double* column = K.valuePtr() + start[c] + at;
        for (int d = 0; d < 3; ++d) column[d] += ascending ? block(c, d) : block(d, c);
    }
}

Eigen::VectorXd Unknowns::gather(const Eigen::VectorXd& u) const {
    Eigen::VectorXd x(size());
    for (std::size_t i = 0; i < number_.size(); ++i) {
        if (number_[i] >= 0) x.segment<3>(3 * number_[i]) = u.segment<3>(static_cast<Eigen::Index>(3 * i));
    }
    return x;
}

Eigen::VectorXd Unknowns::scatter(const Eigen::VectorXd& x) const {
    Eigen::VectorXd u = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(3 * number_.size()));
    for (std::size_t i = 0; i < number_.size(); ++i) {
        if (number_[i] >= 0) u.segment<3>(static_cast<Eigen::Index>(3 * i)) = x.segment<3>(3 * number_[i]);
    }
    return u;
}

EliminationOrder elimination_order(const mesh::VolumeMesh& mesh, const std::vector<char>& held,
                                   const JoinedNodes& joined, Solver solver) {
    std::vector<int> number(held.size()), free;
    for (std::size_t i = 0; i < held.size(); ++i) {
        number[i] = held[i] ? -1 : static_cast<int>(free.size());
        if (!held[i]) free.push_back(static_cast<int>(i));
    }
    if (solver == Solver::automatic || solver == Solver::factor) {
        auto lower = lower_neighbours(mesh, number, joined);
        Elimination elimination = analyse(lower, 3);
        const double needed = cost_of_factor(elimination.supernodes, lower).gigabytes(), allowed = usable_memory();
        if (needed <= allowed) {
            lower = {};
            for (int& k : number) {
                if (k >= 0) k = elimination.position[k];
            }
            return {Unknowns(mesh, std::move(number), joined),
                    std::make_shared<const Supernodes>(std::move(elimination.supernodes))};
        }
        if (solver == Solver::factor) throw SolverFailure(no_room_for_factor(3 * std::ssize(free), needed, allowed));
        solver = Processes::count() > 1 ? Solver::petsc : Solver::multigrid;
    }
    const Points positions = mesh.nodes(free, Eigen::all);
    const std::vector<int> order = morton_order(positions);
    for (std::size_t k = 0; k < order.size(); ++k)
        number[static_cast<std::size_t>(free[static_cast<std::size_t>(order[k])])] = static_cast<int>(k);
    return {Unknowns(mesh, std::move(number), joined), nullptr, solver, positions(order, Eigen::all)};
}

}  // namespace palpate::fem
