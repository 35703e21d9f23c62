#pragma once

#include "fem/rig/actuation.h"

namespace palpate::fem {

/// A tendon's energy by where the points of its path are, with its derivatives.
///
/// With the length L = sum_k |x_k+1 - x_k| and what it is longer than drawn in, s = L - L_rest + value:
///   by tension  Pi = T (L - L_rest)
///   by length   Pi = k/2 max(0, s)^2, k = 10^3 E L_rest: a cable goes slack, and is under the tension k s else
/// In small strain L is taken to first order, from the path at rest.
struct TendonTerms {
    double energy = 0;        // [N mm]
    Points gradient;          // (p x 3) [N]
    Eigen::MatrixXd hessian;  // (3p x 3p) [N/mm]
    TendonState state;
    Points lengthening;    // dL/dx (p x 3)
    double stiffness = 0;  // d tension / dL [N/mm]
};

/// `x`: where the points are (p x 3). @throws InvalidInput for a path of less than two points, or with two in one place
TendonTerms tendon_terms(const TendonPull& pull, const Points& x, bool small_strain);

}  // namespace palpate::fem
