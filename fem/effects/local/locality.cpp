#include "fem/effects/local/locality.h"

namespace palpate::fem {

Eigen::VectorXd Locality::shares(const Points& rest, const Eigen::VectorXd& even) const {
    // By the distance beyond that of the nearest point, so that some weight is left however far it is.
    const Eigen::ArrayXd squares = (rest.rowwise() - centre.transpose()).rowwise().squaredNorm();
    const Eigen::VectorXd weights = even.array() * (-0.5 * (squares - squares.minCoeff()) / (radius * radius)).exp();
    return weights / weights.sum();
}

std::vector<KnownParameter> locality_parameters() {
    return {{"cx", "mm"}, {"cy", "mm"}, {"cz", "mm"}, {"radius", "mm", Range::positive}};
}

Locality locality(const EffectNumbers& numbers) { return {numbers.vector("cx", "cy", "cz"), numbers["radius"]}; }

}  // namespace palpate::fem
