#pragma once

#include <Eigen/Core>
#include <array>

namespace palpate::runtime {

/// What steps reveal of a potential's curvature beyond a factored matrix that is near it: limited-memory BFGS, by the
/// two loops of Nocedal (Math. Comp. 35, 1980). Allocates nothing once it is made.
class LimitedMemoryBfgs {
public:
    explicit LimitedMemoryBfgs(Eigen::Index size);

    void forget() { known_ = 0; }
    /// Adds the pair of a step (`share` times `step`) and the change of the net force. Skipped where the curvature
    /// condition fails.
    void update(double share, const Eigen::VectorXd& step, const Eigen::VectorXd& from, const Eigen::VectorXd& to);
    /// v <- H v, in place; `solve(v)`: the same by the factored matrix alone.
    template <typename Solve>
    void solve(Eigen::VectorXd& v, const Solve& by_matrix);

private:
    struct CurvaturePair {
        Eigen::VectorXd step, change;
        double curvature = 0;  // their product, > 0
        double share = 0;      // work
    };
    std::array<CurvaturePair, 12> pairs_;  // the latest, the oldest first
    int known_ = 0;
};

template <typename Solve>
void LimitedMemoryBfgs::solve(Eigen::VectorXd& v, const Solve& by_matrix) {
    for (int i = known_ - 1; i >= 0; --i) {
        CurvaturePair& pair = pairs_[i];
        pair.share = pair.step.dot(v) / pair.curvature;
        v -= pair.share * pair.change;
    }
    by_matrix(v);
    for (int i = 0; i < known_; ++i) {
        const CurvaturePair& pair = pairs_[i];
        v += (pair.share - pair.change.dot(v) / pair.curvature) * pair.step;
    }
}

}  // namespace palpate::runtime
