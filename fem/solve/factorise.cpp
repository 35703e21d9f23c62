#include "fem/solve/factorise.h"

#include <cblas.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>
#include <tbb/task_group.h>

#include <algorithm>
#include <atomic>

// LAPACK has no C header of its own.
// NOLINTNEXTLINE(readability-identifier-naming)
extern "C" void dpotrf_(const char* uplo, const int* n, double* a, const int* lda, int* info);

namespace palpate::fem {

namespace {

constexpr int tile = 256;  // rows and columns that a thread works on at once: fits the second-level cache

/// Rows [begin, end) below supernode `from`'s own columns are columns of the supernode that is updated.
struct Update {
    int from, begin, end;
};

/// Which supernodes update each one, in the order of elimination.
struct Updates {
    std::vector<std::size_t> start;
    std::vector<Update> list;

    explicit Updates(const Supernodes& structure) : start(structure.count() + 1, 0) {
        std::vector<int> supernode_of(structure.size());
        for (int s = 0; s < structure.count(); ++s) {
            std::fill_n(supernode_of.begin() + structure.first_column[s], structure.columns(s), s);
        }
        const auto for_each = [&](auto&& visit) {
            for (int d = 0; d < structure.count(); ++d) {
                const auto rows = structure.rows_below(d);
                for (int k = 0, end = 0; k < static_cast<int>(rows.size()); k = end) {
                    const int target = supernode_of[rows[k]];
                    while (end < static_cast<int>(rows.size()) && supernode_of[rows[end]] == target) ++end;
                    visit(target, Update{d, k, end});
                }
            }
        };
        for_each([&](int target, const Update&) { ++start[target + 1]; });
        for (std::size_t s = 1; s < start.size(); ++s) start[s] += start[s - 1];
        list.resize(start.back());
        std::vector<std::size_t> next(start.begin(), start.end() - 1);
        for_each([&](int target, const Update& update) { list[next[target]++] = update; });
    }
};

/// What a thread needs while it works on one supernode or tile.
struct Workspace {
    std::vector<int> place;       // of each row of the matrix in the supernode at hand
    std::vector<int> target;      // of the product's rows in the supernode
    std::vector<double> product;  // (tile x tile)
};

class Factorisation {
public:
    Factorisation(const Supernodes& structure, const LowerMatrix& K, double* values)
        : structure_(structure), K_(K), values_(values), updates_(structure), waiting_for_(structure.count()) {
        for (const int parent : structure.parent) {
            if (parent >= 0) ++waiting_for_[parent];
        }
    }

    bool run() {
        // A thread that waits here takes up none of the caller's other work, which may itself wait for this one.
        tbb::this_task_arena::isolate([&] { eliminate_all(); });
        return positive_;
    }

private:
    void eliminate_all() {
        // Leaves of the elimination tree start; who finishes the last child goes on with the parent.
        std::vector<int> leaves;
        for (int s = 0; s < structure_.count(); ++s) {
            if (waiting_for_[s] == 0) leaves.push_back(s);
        }
        tbb::task_group tasks;
        for (const int leaf : leaves) {
            tasks.run([this, leaf] {
                int s = leaf;
                do {
                    if (positive_) eliminate(s);
                    s = structure_.parent[s];
                } while (s >= 0 && --waiting_for_[s] == 0);
            });
        }
        tasks.wait();
    }

    double* block(int s) const { return values_ + structure_.first_value[s]; }

    /// Left-looking: what is left of K's columns after all updates, then a dense factorisation by tiles.
    void eliminate(int s) {
        std::vector<int>& place = workspaces_.local().place;
        place.resize(structure_.size());
        const auto rows = structure_.rows_of(s);
        for (std::size_t k = 0; k < rows.size(); ++k) place[rows[k]] = static_cast<int>(k);
        load(s, place);

        const int row_tiles = (structure_.height(s) + tile - 1) / tile;
        const int column_tiles = (structure_.columns(s) + tile - 1) / tile;
        for_tiles(row_tiles * column_tiles, [&](int k) {
            const int i = k % row_tiles, j = k / row_tiles;
            if (i >= j) gather(s, i * tile, j * tile, place);
        });
        for (int j = 0; j < column_tiles && positive_; ++j) {
            for_tiles(row_tiles - j, [&](int k) { subtract_left(s, (j + k) * tile, j * tile); });
            factor_diagonal(s, j * tile);
            for_tiles(row_tiles - j, [&](int k) { divide(s, (j + k) * tile, j * tile); });
        }
    }

    /// In parallel where there is more than one. A thread that waits here takes up no other supernode, as its `place`
    /// is still in use.
    template <class Work>
    static void for_tiles(int count, Work&& work) {
        if (count == 1) return work(0);
        tbb::this_task_arena::isolate([&] { tbb::parallel_for(0, count, work, tbb::simple_partitioner()); });
    }

    /// The columns of K.
    void load(int s, const std::vector<int>& place) {
        std::fill(block(s), block(s + 1), 0.0);
        for (int c = 0; c < structure_.columns(s); ++c) {
            double* column = block(s) + static_cast<std::int64_t>(c) * structure_.height(s);
            for (LowerMatrix::InnerIterator entry(K_, structure_.first_column[s] + c); entry; ++entry) {
                column[place[entry.row()]] = entry.value();
            }
        }
    }

    /// Subtracts L_d L_d^T of all earlier supernodes d from the tile at (row, column) of supernode s.
    void gather(int s, int row, int column, const std::vector<int>& place) {
        Workspace& workspace = workspaces_.local();
        workspace.product.resize(static_cast<std::size_t>(tile) * tile);
        const int height = structure_.height(s);
        const int row_end = std::min(row + tile, height), column_end = std::min(column + tile, structure_.columns(s));
        for (std::size_t u = updates_.start[s]; u < updates_.start[s + 1]; ++u) {
            const auto [d, begin, end] = updates_.list[u];
            const auto rows = structure_.rows_below(d);
            // Which rows of d fall into the tile's columns and rows.
            const auto first_from = [&](int k, int position) {
                return static_cast<int>(
                    std::partition_point(rows.begin() + k, rows.end(), [&](int r) { return place[r] < position; }) -
                    rows.begin());
            };
            const int c0 = first_from(begin, column), c1 = std::min(end, first_from(begin, column_end));
            const int r0 = first_from(begin, row), r1 = first_from(begin, row_end);
            const int m = r1 - r0, n = c1 - c0;
            if (m <= 0 || n <= 0) continue;

            const double* below = block(d) + structure_.columns(d);
            cblas_dgemm(CblasColMajor, CblasNoTrans, CblasTrans, m, n, structure_.columns(d), 1.0, below + r0,
                        structure_.height(d), below + c0, structure_.height(d), 0.0, workspace.product.data(), m);
            workspace.target.resize(m);
            for (int k = 0; k < m; ++k) workspace.target[k] = place[rows[r0 + k]];
            for (int c = 0; c < n; ++c) {
                double* to = block(s) + static_cast<std::int64_t>(place[rows[c0 + c]]) * height;
                const double* from = &workspace.product[static_cast<std::size_t>(c) * m];
                for (int k = 0; k < m; ++k) to[workspace.target[k]] -= from[k];
            }
        }
    }

    /// The same for the supernode's own columns to the left of the tile.
    void subtract_left(int s, int row, int column) {
        if (column == 0) return;
        const int height = structure_.height(s);
        double* L = block(s);
        cblas_dgemm(CblasColMajor, CblasNoTrans, CblasTrans, std::min(tile, height - row),
                    std::min(tile, structure_.columns(s) - column), column, -1.0, L + row, height, L + column, height,
                    1.0, L + row + static_cast<std::int64_t>(column) * height, height);
    }

    void factor_diagonal(int s, int column) {
        const int height = structure_.height(s), n = std::min(tile, structure_.columns(s) - column);
        int info = 0;
        dpotrf_("L", &n, block(s) + column + static_cast<std::int64_t>(column) * height, &height, &info);
        if (info != 0) positive_ = false;
    }

    /// Rows below the diagonal tile: A <- A L11^-T. The diagonal tile's own rows below its columns belong to it too.
    void divide(int s, int row, int column) {
        const int height = structure_.height(s), n = std::min(tile, structure_.columns(s) - column);
        const int begin = std::max(row, column + n), m = std::min(row + tile, height) - begin;
        if (m <= 0 || !positive_) return;
        double* columns = block(s) + static_cast<std::int64_t>(column) * height;
        cblas_dtrsm(CblasColMajor, CblasRight, CblasLower, CblasTrans, CblasNonUnit, m, n, 1.0, columns + column,
                    height, columns + begin, height);
    }

    const Supernodes& structure_;
    const LowerMatrix& K_;
    double* values_;
    Updates updates_;
    std::vector<std::atomic<int>> waiting_for_;  // children of each supernode that are not done
    std::atomic<bool> positive_ = true;
    tbb::enumerable_thread_specific<Workspace> workspaces_;
};

}  // namespace

bool factorise(const Supernodes& structure, const LowerMatrix& K, double* values) {
    return Factorisation(structure, K, values).run();
}

}  // namespace palpate::fem
