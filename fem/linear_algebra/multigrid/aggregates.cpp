#include "fem/linear_algebra/multigrid/aggregates.h"

#include <algorithm>
#include <cmath>

namespace palpate::fem {

namespace {

constexpr int none = -1;

/// How strongly nodes are connected: |A_ij| / sqrt(|A_ii| |A_jj|), for each block of A.
template <int b>
std::vector<float> strengths(const BlockMatrix<b, b>& A) {
    std::vector<float> result(A.blocks());
    std::vector<double> root(A.rows(), 1.0);  // of the diagonal block's norm
    for (int i = 0; i < A.rows(); ++i) {
        for (int k = 0; k < A.count(i); ++k) {
            const double norm = A.block(i, k).norm();
            result[A.start[i] + k] = static_cast<float>(norm);
            if (A.columns_of(i)[k] == i && norm > 0) root[i] = std::sqrt(norm);
        }
    }
    for (int i = 0; i < A.rows(); ++i) {
        for (int k = 0; k < A.count(i); ++k) {
            result[A.start[i] + k] /= static_cast<float>(root[i] * root[A.columns_of(i)[k]]);
        }
    }
    return result;
}

template <int b>
class Aggregation {
public:
    Aggregation(const BlockMatrix<b, b>& A, double threshold)
        : A_(A), strength_(strengths(A)), threshold_(static_cast<float>(threshold)), of_node_(A.rows(), none) {}

    Aggregates run() {
        // Whole neighbourhoods first; then what lies between them.
        for (int i = 0; i < A_.rows(); ++i) {
            if (is_whole(i)) gather(i);
        }
        join();
        for (int i = 0; i < A_.rows(); ++i) {
            if (of_node_[i] == none) gather(i);
        }
        return {std::move(of_node_), count_};
    }

private:
    template <class Visit>
    void for_strong(int i, Visit&& visit) const {
        for (int k = 0; k < A_.count(i); ++k) {
            if (strength_[A_.start[i] + k] >= threshold_) visit(A_.columns_of(i)[k]);
        }
    }

    /// Has it strong neighbours, all of them free?
    bool is_whole(int i) const {
        int neighbours = 0;
        bool free = of_node_[i] == none;
        for_strong(i, [&](int j) {
            free = free && of_node_[j] == none;
            neighbours += j != i;
        });
        return free && neighbours > 0;
    }

    void gather(int i) {
        of_node_[i] = count_;
        for_strong(i, [&](int j) {
            if (of_node_[j] == none) of_node_[j] = count_;
        });
        ++count_;
    }

    void join() {
        std::vector<int> joined = of_node_;
        for (int i = 0; i < A_.rows(); ++i) {
            float strongest = 0;
            for (int k = 0; of_node_[i] == none && k < A_.count(i); ++k) {
                const int other = of_node_[A_.columns_of(i)[k]];
                const float strength = strength_[A_.start[i] + k];
                if (other == none || strength <= strongest) continue;
                strongest = strength;
                joined[i] = other;
            }
        }
        of_node_ = std::move(joined);
    }

    const BlockMatrix<b, b>& A_;
    const std::vector<float> strength_;
    const float threshold_;
    std::vector<int> of_node_;
    int count_ = 0;
};

}  // namespace

template <int b>
Aggregates aggregate(const BlockMatrix<b, b>& A, double threshold) {
    return Aggregation<b>(A, threshold).run();
}

template Aggregates aggregate(const BlockMatrix<3, 3>&, double);
template Aggregates aggregate(const BlockMatrix<6, 6>&, double);

}  // namespace palpate::fem
