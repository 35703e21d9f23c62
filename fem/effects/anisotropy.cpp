#include "fem/effects/anisotropy.h"

#include <cassert>

namespace palpate::fem {

Anisotropy::Anisotropy(std::vector<Fibre> fibres) : fibres_(std::move(fibres)) {
    for (Fibre& fibre : fibres_) {
        assert(fibre.n.norm() > 0);
        fibre.n.normalize();
    }
}

MaterialTerms Anisotropy::terms(const Vec3& /*X*/, const Mat3& F, bool with_second) const {
    MaterialTerms result;
    for (const auto& [k, n] : fibres_) {
        // d (n.E n) / dF = F n n^T
        const Vec3 along = F * n;
        const double strain = (along.squaredNorm() - 1) / 2;
        const Mat3 by_F = along * n.transpose();
        result.w += k / 2 * strain * strain;
        result.first += k * strain * by_F;
        if (!with_second) continue;
        for (int c = 0; c < 3; ++c) {
            for (int d = 0; d < 3; ++d) {
                const double factor = k * (along(c) * along(d) + (c == d ? strain : 0));
                result.second.block<3, 3>(Eigen::Index{3} * c, Eigen::Index{3} * d) += factor * n * n.transpose();
            }
        }
    }
    return result;
}

}  // namespace palpate::fem
