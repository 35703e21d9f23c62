#include "skeleton/blocks/block_cholesky.h"

#include <Eigen/OrderingMethods>
#include <Eigen/SparseCore>
#include <algorithm>
#include <cassert>
#include <cmath>

namespace palpate::skeleton {

namespace {

// Pivots below this share of the matrix's own diagonal entry are rounding.
constexpr double singular = 1e-13;

// Cholesky factor of a block in its lower half; the entry of the first pivot not above `least`, or 6.
int factor_block(PaddedBlock& A, const BlockCholesky::Vec6& least) {
    for (int j = 0; j < 6; ++j) {
        if (!(A(j, j) > least[j])) return j;
        A(j, j) = std::sqrt(A(j, j));
        for (int i = j + 1; i < 6; ++i) A(i, j) /= A(j, j);
        for (int k = j + 1; k < 6; ++k)
            for (int i = k; i < 6; ++i) A(i, k) -= A(i, j) * A(k, j);
    }
    return 6;
}

void pad(const BlockCholesky::Block& from, PaddedBlock& to) {
    for (int j = 0; j < 6; ++j) {
        std::copy_n(from.data() + Eigen::Index{6} * j, 6, to.columns[j]);
        to.columns[j][6] = to.columns[j][7] = 0;
    }
}

}  // namespace

BlockCholesky::BlockCholesky(int n, const std::vector<std::array<int, 2>>& couplings) : n_(n) {
    // Order by minimum degree on the graph of the blocks.
    std::vector<Eigen::Triplet<double>> entries;
    entries.reserve(static_cast<size_t>(n) + 2 * couplings.size());
    for (int i = 0; i < n; ++i) entries.emplace_back(i, i, 1.0);
    for (const auto& [i, j] : couplings) {
        entries.emplace_back(i, j, 1.0);
        entries.emplace_back(j, i, 1.0);
    }
    Eigen::SparseMatrix<double> graph(n, n);
    graph.setFromTriplets(entries.begin(), entries.end());
    Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> order;
    if (n > 0) Eigen::AMDOrdering<int>()(graph, order);
    block_at_.assign(order.indices().data(), order.indices().data() + n);
    position_.resize(n);
    for (int p = 0; p < n; ++p) position_[block_at_[p]] = p;

    factor_symbolically(couplings);

    // Places of the matrix's own blocks.
    for (int i = 0; i < n; ++i) slot_of_diagonal_.push_back(columns_[position_[i]].first);
    for (const auto& [i, j] : couplings) {
        const int p = position_[i], q = position_[j];
        slot_of_coupling_.push_back(slot(std::max(p, q), std::min(p, q)));
        transposed_.push_back(p < q);
    }
    set_zero();
}

void BlockCholesky::factor_symbolically(const std::vector<std::array<int, 2>>& couplings) {
    columns_.resize(n_);
    touching_.resize(n_);
    for (const auto& [i, j] : couplings)
        columns_[std::min(position_[i], position_[j])].rows.push_back(std::max(position_[i], position_[j]));

    // A column passes its rows on to its parent, the first of them.
    int blocks = 0;
    for (int j = 0; j < n_; ++j) {
        std::vector<int>& rows = columns_[j].rows;
        std::sort(rows.begin(), rows.end());
        rows.erase(std::unique(rows.begin(), rows.end()), rows.end());
        columns_[j].first = blocks;
        blocks += 1 + static_cast<int>(rows.size());
        for (const int i : rows) touching_[i].push_back(j);
        if (!rows.empty()) {
            std::vector<int>& parent = columns_[rows.front()].rows;
            parent.insert(parent.end(), rows.begin() + 1, rows.end());
        }
    }
    matrix_.resize(blocks);
    factor_.resize(blocks);
    place_.resize(n_);
    right_hand_.resize(std::size_t{8} * n_);
}

int BlockCholesky::slot(int row, int column) const {
    const std::vector<int>& rows = columns_[column].rows;
    const auto found = std::lower_bound(rows.begin(), rows.end(), row);
    assert(found != rows.end() && *found == row);
    return columns_[column].first + 1 + static_cast<int>(found - rows.begin());
}

void BlockCholesky::set_zero() {
    for (Block& block : matrix_) block.setZero();
}

void BlockCholesky::add_coupling(int c, const Block& A) {
    if (transposed_[c])
        matrix_[slot_of_coupling_[c]] += A.transpose();
    else
        matrix_[slot_of_coupling_[c]] += A;
}

std::optional<BlockCholesky::BadPivot> BlockCholesky::factor(double shift, const Vec6& scale) {
    for (int j = 0; j < n_; ++j) {
        const Column& column = columns_[j];
        const int size = 1 + static_cast<int>(column.rows.size());
        PaddedBlock* const values = factor_.data() + column.first;
        for (int i = 0; i < size; ++i) pad(matrix_[column.first + i], values[i]);
        Vec6 entries;
        for (int i = 0; i < 6; ++i) entries[i] = values->columns[i][i] += shift * scale[i];
        place_[j] = values;
        for (int i = 1; i < size; ++i) place_[column.rows[i - 1]] = values + i;

        // Left-looking: subtract what the columns before contribute, L_ik L_jk^T.
        for (const int k : touching_[j]) {
            const Column& before = columns_[k];
            const auto start = std::lower_bound(before.rows.begin(), before.rows.end(), j) - before.rows.begin();
            subtract_products(factor_.data() + before.first + 1 + start, before.rows.data() + start,
                              static_cast<int>(std::ssize(before.rows) - start), place_.data());
        }

        const int entry = factor_block(values[0], singular * entries.cwiseAbs());
        if (entry < 6) {
            const double pivot = values[0](entry, entry);
            return BadPivot{block_at_[j], entry, pivot >= -singular * std::abs(entries[entry])};
        }
        divide_by_transpose(values[0], values + 1, size - 1);
    }
    return std::nullopt;
}

double BlockCholesky::cost_in_solutions() const {
    double blocks = 0, products = 0;
    for (const Column& column : columns_) {
        const auto size = static_cast<double>(column.rows.size());
        blocks += 1 + size;
        products += 0.5 * size * (size + 1);
    }
    return n_ > 0 ? 6 * products / (2 * blocks) : 0;
}

void BlockCholesky::solve(double* b, Eigen::Index columns, double* work) const {
    const Eigen::Index from = Eigen::Index{6} * n_, to = Eigen::Index{8} * n_;  // of one column to the next
    for (Eigen::Index c = 0; c < columns; ++c) {
        for (int p = 0; p < n_; ++p) {
            double* const own = work + c * to + Eigen::Index{8} * p;
            std::copy_n(b + c * from + Eigen::Index{6} * block_at_[p], 6, own);
            own[6] = own[7] = 0;
        }
    }
    // L z = b, L^T x = z; a column of L is read from memory once for all of b
    for (int j = 0; j < n_; ++j) {
        const Column& column = columns_[j];
        for (Eigen::Index c = 0; c < columns; ++c) {
            solve_forward(factor_.data() + column.first, column.rows.data(), static_cast<int>(column.rows.size()), j,
                          work + c * to);
        }
    }
    for (int j = n_ - 1; j >= 0; --j) {
        const Column& column = columns_[j];
        for (Eigen::Index c = 0; c < columns; ++c) {
            solve_backward(factor_.data() + column.first, column.rows.data(), static_cast<int>(column.rows.size()), j,
                           work + c * to);
        }
    }
    for (Eigen::Index c = 0; c < columns; ++c) {
        for (int p = 0; p < n_; ++p) {
            std::copy_n(work + c * to + Eigen::Index{8} * p, 6, b + c * from + Eigen::Index{6} * block_at_[p]);
        }
    }
}

void BlockCholesky::solve(double* b) { solve(b, 1, right_hand_.data()); }

void BlockCholesky::solve(Eigen::MatrixXd& B) const {
    assert(B.rows() == 6 * n_);
    constexpr Eigen::Index together = 16;
    std::vector<double> work(std::size_t{8} * n_ * std::min(together, B.cols()));
    for (Eigen::Index c = 0; c < B.cols(); c += together) {
        solve(B.col(c).data(), std::min(together, B.cols() - c), work.data());
    }
}

}  // namespace palpate::skeleton
