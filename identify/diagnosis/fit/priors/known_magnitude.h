#pragma once

#include "identify/effects/effect.h"

namespace palpate::identify {

/// A vector g of which the magnitude is known, the direction is not, in the light of measurements:
///   p(g) = N(|g|; mean, sd) / (4 pi |g|^2)
struct KnownMagnitude {
    Vec3 value;                   // of that magnitude, in the mean direction
    Mat3 covariance;              // about it: measurements may leave much of a circle open
    double log_bayes_factor = 0;  // beside the prior N(0, prior_sd) of each component
};

/// `free`, `covariance`: the posterior N(free, covariance) under the prior N(0, prior_sd) of each component, so that
/// the likelihood is what it has beyond that. By quadrature over directions.
KnownMagnitude with_known_magnitude(const Vec3& free, const Mat3& covariance, const Vec3& prior_sd,
                                    const MagnitudePrior& known);

}  // namespace palpate::identify
