#include "fem/effects/local/locality.h"

#include <cmath>

namespace palpate::fem {

double Locality::weight(const Vec3& X) const { return std::exp(-0.5 * (X - centre).squaredNorm() / (radius * radius)); }

Eigen::VectorXd Locality::shares(const Points& rest, const Eigen::VectorXd& even) const {
    // By the distance beyond that of the nearest point, so that some weight is left however far it is.
    const Eigen::ArrayXd squares = (rest.rowwise() - centre.transpose()).rowwise().squaredNorm();
    const Eigen::VectorXd weights = even.array() * (-0.5 * (squares - squares.minCoeff()) / (radius * radius)).exp();
    return weights / weights.sum();
}

}  // namespace palpate::fem
