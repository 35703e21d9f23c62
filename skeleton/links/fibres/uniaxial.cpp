#include "skeleton/links/fibres/uniaxial.h"

#include <cmath>

namespace palpate::skeleton {

StretchTerms uniaxial(const fem::MaterialEffect& effect, const Vec3& X, const Vec3& n, double lambda,
                      bool with_second) {
    const Mat3 along = n * n.transpose(), across = Mat3::Identity() - along;
    const double root = 1 / std::sqrt(lambda);
    const Mat3 F = lambda * along + root * across;
    const Mat3 dF = along - (0.5 * root / lambda) * across;
    const fem::MaterialTerms terms = effect.terms(X, F, with_second);

    StretchTerms result{terms.w, terms.first.cwiseProduct(dF).sum(), 0};
    if (with_second) {
        const Mat3 ddF = (0.75 * root / (lambda * lambda)) * across;
        const Eigen::Matrix<double, 9, 1> v = dF.reshaped();  // symmetric: rows first or columns first
        result.second = v.dot(terms.second * v) + terms.first.cwiseProduct(ddF).sum();
    }
    return result;
}

}  // namespace palpate::skeleton
