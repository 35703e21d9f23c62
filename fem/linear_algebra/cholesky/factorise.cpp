#include "fem/linear_algebra/cholesky/factorise.h"

#include <cblas.h>
#include <tbb/concurrent_queue.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/task_arena.h>
#include <tbb/task_group.h>

#include <algorithm>
#include <atomic>
#include <memory>
#include <utility>

// LAPACK has no C header of its own.
// NOLINTNEXTLINE(readability-identifier-naming)
extern "C" void dpotrf_(const char* uplo, const int* n, double* a, const int* lda, int* info);

namespace palpate::fem {

namespace {

constexpr int width = 256;  // of a panel of columns that are factored together; a product's rows there
constexpr int tall = 1024;  // rows of a panel that are gathered together: their product fits the second-level cache

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

/// Rows [row, row_end) of columns [column, column_end) of a supernode.
struct Tile {
    int row, row_end, column, column_end;
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
    struct Job;
    using Work = void (Factorisation::*)(const Job&, const Tile&);

    /// Tiles that can be worked on at once.
    struct Step {
        Work work;
        std::vector<Tile> tiles;
    };

    /// A supernode that is being eliminated, step by step. Whoever is done with a step's last tile goes on with the
    /// next step: nobody waits, and who has no other work helps with any tile.
    struct Job {
        explicit Job(int size) : place(size) {}
        int s = 0;
        std::vector<int> place;  // of each row of the matrix in the supernode
        std::vector<Step> steps;
        std::size_t next = 0;       // step
        std::atomic<int> left = 0;  // tiles of the step that are not done
    };

    /// What a thread needs while it works on a tile.
    struct Workspace {
        std::vector<int> target;      // of the product's rows in the supernode
        std::vector<double> product;  // (tall x tile)
    };

    void eliminate_all() {
        // Leaves of the elimination tree start; who finishes the last child goes on with the parent.
        std::vector<int> leaves;
        for (int s = 0; s < structure_.count(); ++s) {
            if (waiting_for_[s] == 0) leaves.push_back(s);
        }
        for (const int leaf : leaves) {
            tasks_.run([this, leaf] {
                std::shared_ptr<Job> job;
                if (!idle_.try_pop(job)) job = std::make_shared<Job>(structure_.size());
                start(*job, leaf);
                go_on(job);
            });
        }
        tasks_.wait();
    }

    /// Left-looking: what is left of K's columns after all updates, then a dense factorisation by panels of columns.
    void start(Job& job, int s) {
        const auto rows = structure_.rows_of(s);
        for (std::size_t k = 0; k < rows.size(); ++k) job.place[rows[k]] = static_cast<int>(k);
        job.s = s;
        job.next = 0;
        job.steps.clear();

        const int height = structure_.height(s), columns = structure_.columns(s);
        std::vector<Tile> tiles;
        const auto add = [&](Tile all, int rows_together) {
            for (int row = all.row; row < all.row_end; row += rows_together) {
                tiles.push_back({row, std::min(row + rows_together, all.row_end), all.column, all.column_end});
            }
        };
        const auto add_step = [&](Work work) {
            if (!tiles.empty()) job.steps.push_back({work, std::exchange(tiles, {})});
        };
        for (int c = 0; c < columns; c += width) add({c, height, c, std::min(c + width, columns)}, tall);
        add_step(&Factorisation::gather);
        for (int c = 0; c < columns; c += width) {
            const int end = std::min(c + width, columns);
            if (c > 0) add({c, height, c, end}, width);
            add_step(&Factorisation::subtract_left);
            add({c, end, c, end}, width);
            add_step(&Factorisation::factor_diagonal);
            add({end, height, c, end}, width);
            add_step(&Factorisation::divide);
        }
    }

    /// The job's next steps, and those of the supernodes above that wait for it alone.
    void go_on(const std::shared_ptr<Job>& job) {
        do {
            while (job->next < job->steps.size()) {
                const Step& step = job->steps[job->next++];
                const auto count = static_cast<int>(step.tiles.size());
                job->left = count;
                for (int k = 1; k < count; ++k) {
                    tasks_.run([this, job, &step, k] {
                        if (is_last(*job, step, k)) go_on(job);
                    });
                }
                if (!is_last(*job, step, 0)) return;
            }
        } while (go_up(*job));
        idle_.push(job);
    }

    /// Works on a tile; whether it was the last of its step.
    bool is_last(Job& job, const Step& step, int k) {
        if (positive_) (this->*step.work)(job, step.tiles[k]);
        return --job.left == 0;
    }

    bool go_up(Job& job) {
        const int parent = structure_.parent[job.s];
        if (!positive_ || parent < 0 || --waiting_for_[parent] > 0) return false;
        start(job, parent);
        return true;
    }

    double* block(int s) const { return values_ + structure_.first_value[s]; }
    double* at(int s, int row, int column) const {
        return block(s) + row + static_cast<std::int64_t>(column) * structure_.height(s);
    }

    /// What is left of K's entries when L_d L_d^T of all earlier supernodes d is subtracted.
    void gather(const Job& job, const Tile& t) {
        load(job, t);
        Workspace& workspace = workspaces_.local();
        workspace.product.resize(static_cast<std::size_t>(tall) * width);
        const int s = job.s, height = structure_.height(s);
        for (std::size_t u = updates_.start[s]; u < updates_.start[s + 1]; ++u) {
            const auto [d, begin, end] = updates_.list[u];
            const auto rows = structure_.rows_below(d);
            // Which rows of d fall into the tile's columns and rows.
            const auto first_from = [&](int k, int position) {
                return static_cast<int>(
                    std::partition_point(rows.begin() + k, rows.end(), [&](int r) { return job.place[r] < position; }) -
                    rows.begin());
            };
            const int c0 = first_from(begin, t.column), c1 = std::min(end, first_from(begin, t.column_end));
            const int r0 = first_from(begin, t.row), r1 = first_from(begin, t.row_end);
            const int m = r1 - r0, n = c1 - c0;
            if (m <= 0 || n <= 0) continue;

            const double* below = block(d) + structure_.columns(d);
            cblas_dgemm(CblasColMajor, CblasNoTrans, CblasTrans, m, n, structure_.columns(d), 1.0, below + r0,
                        structure_.height(d), below + c0, structure_.height(d), 0.0, workspace.product.data(), m);
            workspace.target.resize(m);
            for (int k = 0; k < m; ++k) workspace.target[k] = job.place[rows[r0 + k]];
            for (int c = 0; c < n; ++c) {
                double* to = block(s) + static_cast<std::int64_t>(job.place[rows[c0 + c]]) * height;
                const double* from = &workspace.product[static_cast<std::size_t>(c) * m];
                for (int k = 0; k < m; ++k) to[workspace.target[k]] -= from[k];
            }
        }
    }

    void load(const Job& job, const Tile& t) {
        for (int c = t.column; c < t.column_end; ++c) {
            double* column = block(job.s) + static_cast<std::int64_t>(c) * structure_.height(job.s);
            std::fill(column + t.row, column + t.row_end, 0.0);
            for (LowerMatrix::InnerIterator entry(K_, structure_.first_column[job.s] + c); entry; ++entry) {
                const int row = job.place[entry.row()];
                if (row >= t.row && row < t.row_end) column[row] = entry.value();
            }
        }
    }

    /// Subtracts what the supernode's own columns to the left give.
    void subtract_left(const Job& job, const Tile& t) {
        const int height = structure_.height(job.s);
        double* L = block(job.s);
        cblas_dgemm(CblasColMajor, CblasNoTrans, CblasTrans, t.row_end - t.row, t.column_end - t.column, t.column, -1.0,
                    L + t.row, height, L + t.column, height, 1.0, at(job.s, t.row, t.column), height);
    }

    void factor_diagonal(const Job& job, const Tile& t) {
        const int height = structure_.height(job.s), n = t.column_end - t.column;
        int info = 0;
        dpotrf_("L", &n, at(job.s, t.row, t.column), &height, &info);
        if (info != 0) positive_ = false;
    }

    /// Below the diagonal: A <- A L11^-T.
    void divide(const Job& job, const Tile& t) {
        const int height = structure_.height(job.s);
        cblas_dtrsm(CblasColMajor, CblasRight, CblasLower, CblasTrans, CblasNonUnit, t.row_end - t.row,
                    t.column_end - t.column, 1.0, at(job.s, t.column, t.column), height, at(job.s, t.row, t.column),
                    height);
    }

    const Supernodes& structure_;
    const LowerMatrix& K_;
    double* values_;
    Updates updates_;
    std::vector<std::atomic<int>> waiting_for_;  // children of each supernode that are not done
    std::atomic<bool> positive_ = true;
    tbb::enumerable_thread_specific<Workspace> workspaces_;
    tbb::concurrent_queue<std::shared_ptr<Job>> idle_;
    tbb::task_group tasks_;
};

}  // namespace

bool factorise(const Supernodes& structure, const LowerMatrix& K, double* values) {
    return Factorisation(structure, K, values).run();
}

}  // namespace palpate::fem
