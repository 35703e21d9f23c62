#pragma once

#include <Eigen/Core>
#include <array>

namespace palpate::runtime {

/// What steps tell of a potential's curvature beyond a factored matrix that is near it: limited-memory BFGS, by the two
/// loops of Nocedal (Math. Comp. 35, 1980). Allocates nothing once it is made.
class LearntCurvature {
public:
    explicit LearntCurvature(Eigen::Index size);

    void forget() { known_ = 0; }
    /// That a share of the step `way` led from one net force to another (size each). Nothing is learnt where the
    /// potential curves downwards.
    void learn(double share, const Eigen::VectorXd& way, const Eigen::VectorXd& from, const Eigen::VectorXd& to);
    /// v <- H v, in place; `solve(v)`: the same by the factored matrix alone.
    template <typename Solve>
    void solve(Eigen::VectorXd& v, const Solve& by_matrix);

private:
    struct Known {
        Eigen::VectorXd way, change;
        double curvature = 0;  // their product, > 0
        double share = 0;      // work
    };
    std::array<Known, 12> pairs_;  // the latest, the oldest first
    int known_ = 0;
};

template <typename Solve>
void LearntCurvature::solve(Eigen::VectorXd& v, const Solve& by_matrix) {
    for (int i = known_ - 1; i >= 0; --i) {
        Known& pair = pairs_[i];
        pair.share = pair.way.dot(v) / pair.curvature;
        v -= pair.share * pair.change;
    }
    by_matrix(v);
    for (int i = 0; i < known_; ++i) {
        const Known& pair = pairs_[i];
        v += (pair.share - pair.change.dot(v) / pair.curvature) * pair.way;
    }
}

}  // namespace palpate::runtime
