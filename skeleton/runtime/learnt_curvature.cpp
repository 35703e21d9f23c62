#include "skeleton/runtime/learnt_curvature.h"

#include <algorithm>

namespace palpate::runtime {

LearntCurvature::LearntCurvature(Eigen::Index size) {
    for (Known& pair : pairs_) {
        pair.way.setZero(size);
        pair.change.setZero(size);
    }
}

void LearntCurvature::learn(double share, const Eigen::VectorXd& way, const Eigen::VectorXd& from,
                            const Eigen::VectorXd& to) {
    const double curvature = share * way.dot(from - to);
    if (!(curvature > 0)) return;
    if (known_ == static_cast<int>(pairs_.size())) {
        std::rotate(pairs_.begin(), pairs_.begin() + 1, pairs_.end());
    } else {
        ++known_;
    }
    Known& pair = pairs_[known_ - 1];
    pair.way = share * way;
    pair.change = from - to;
    pair.curvature = curvature;
}

}  // namespace palpate::runtime
