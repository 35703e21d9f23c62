#include "skeleton/runtime/solver/learnt_curvature.h"

#include <algorithm>

namespace palpate::runtime {

LimitedMemoryBfgs::LimitedMemoryBfgs(Eigen::Index size) {
    for (CurvaturePair& pair : pairs_) {
        pair.step.setZero(size);
        pair.change.setZero(size);
    }
}

void LimitedMemoryBfgs::update(double share, const Eigen::VectorXd& step, const Eigen::VectorXd& from,
                               const Eigen::VectorXd& to) {
    const double curvature = share * step.dot(from - to);
    if (!(curvature > 0)) return;
    if (known_ == static_cast<int>(pairs_.size())) {
        std::rotate(pairs_.begin(), pairs_.begin() + 1, pairs_.end());
    } else {
        ++known_;
    }
    CurvaturePair& pair = pairs_[known_ - 1];
    pair.step = share * step;
    pair.change = from - to;
    pair.curvature = curvature;
}

}  // namespace palpate::runtime
