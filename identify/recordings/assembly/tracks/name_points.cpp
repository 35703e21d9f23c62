#include "identify/recordings/assembly/tracks/name_points.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace palpate::identify {
namespace {

// A body bent to half its length leaves ten to fifteen per cent, another order half as much again.
constexpr double clear_ratio = 1.5;
constexpr long most_trials = 20'000'000;  // a second's work

constexpr double infinity = std::numeric_limits<double>::infinity();

/// Depth-first over assignments; keeps the best two.
class NameSearch {
public:
    NameSearch(const Points& seen, const Points& wanted) : is_taken_(static_cast<std::size_t>(seen.rows()), 0) {
        const auto m = wanted.rows(), n = seen.rows();
        D_ = distances(wanted);
        d_ = distances(seen);
        double nearest = infinity;
        for (Eigen::Index i = 0; i < m; ++i)
            for (Eigen::Index j = 0; j < i; ++j)
                if (D_(i, j) > 0) nearest = std::min(nearest, D_(i, j));
        W_ = (nearest / D_.array().square()).square();  // (D_min / D)^2 / D^2, up to a factor of 1 / D_min^2
        W_.diagonal().setZero();
        for (Eigen::Index i = 0; i < m; ++i)
            if (wanted.row(i).allFinite()) order_.push_back(static_cast<int>(i));
        for (Eigen::Index j = 0; j < n; ++j)
            if (seen.row(j).allFinite()) there_.push_back(static_cast<int>(j));
        // fewer seen than wanted: some stay out, which costs as much as a pair that is off by half
        may_skip_ = there_.size() < order_.size() ? order_.size() - there_.size() : 0;
        chosen_.assign(static_cast<std::size_t>(m), -1);
    }

    PointNames result() {
        descend(0, 0, 0);
        PointNames names{best_, 0, infinity, false};
        if (best_.empty()) {
            names.seen_of.assign(chosen_.size(), -1);
            return names;
        }
        double weight = 0;
        for (const int a : order_)
            for (const int b : order_)
                if (a < b && best_[a] >= 0 && best_[b] >= 0) weight += W_(a, b) * D_(a, b) * D_(a, b);
        const auto share = [&](double cost) { return weight > 0 ? std::sqrt(cost / weight) : 0; };
        names.misfit = share(least_);
        if (std::isfinite(second_)) names.second = share(second_);
        // distances equal to a ten-thousandth are equal: symmetric points cannot be told apart
        constexpr double equal = 1e-4;
        names.is_clear = trials_ < most_trials && names.second > std::max(clear_ratio * names.misfit, equal);
        return names;
    }

private:
    static Eigen::MatrixXd distances(const Points& points) {
        Eigen::MatrixXd d(points.rows(), points.rows());
        for (Eigen::Index i = 0; i < points.rows(); ++i)
            d.row(i) = (points.rowwise() - points.row(i)).rowwise().norm().transpose();
        return d;
    }

    double added(std::size_t depth, int seen) const {
        double cost = 0;
        for (std::size_t before = 0; before < depth; ++before) {
            const int other = chosen_[order_[before]];
            if (other < 0) continue;
            const double off = d_(seen, other) - D_(order_[depth], order_[before]);
            cost += W_(order_[depth], order_[before]) * off * off;
        }
        return cost;
    }

    void descend(std::size_t depth, double cost, std::size_t skipped) {
        if (++trials_ >= most_trials || cost >= second_) return;
        if (depth == order_.size()) {
            if (cost < least_) {
                second_ = least_;
                least_ = cost;
                best_ = chosen_;
            } else {
                second_ = cost;
            }
            return;
        }
        for (const int seen : there_) {
            if (is_taken_[seen] != 0) continue;
            is_taken_[seen] = 1;
            chosen_[order_[depth]] = seen;
            descend(depth + 1, cost + added(depth, seen), skipped);
            is_taken_[seen] = 0;
        }
        chosen_[order_[depth]] = -1;
        if (skipped < may_skip_) descend(depth + 1, cost, skipped + 1);
    }

    Eigen::MatrixXd D_, d_, W_;
    std::vector<int> order_, there_, chosen_, best_;
    std::vector<char> is_taken_;
    std::size_t may_skip_ = 0;
    double least_ = infinity, second_ = infinity;
    long trials_ = 0;
};

}  // namespace

PointNames name_points(const Points& seen, const Points& wanted) { return NameSearch(seen, wanted).result(); }

}  // namespace palpate::identify
