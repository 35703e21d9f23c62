#pragma once

#include "fem/rig/actuation.h"

namespace palpate::fem {

/// A tendon's energy by where the points of its path are, with its derivatives.
///
/// With the lengths L_k = |x_k+1 - x_k| of its segments, their changes d_k = L_k - L_k,rest, and the shares c_k of the
/// tension that friction leaves them (1 without):
///   by tension  Pi = T sum_k c_k d_k
///   by length   Pi = k/2 max(0, s)^2, s = value + sum_k c_k d_k + e, k = 10^3 E L_rest: a cable goes slack, and is
///               under the tension k s else; e = sum_k (1 - c_k) d_k, so that s is what it is longer than drawn in
/// Forces are the gradient with c_k and e held. In small strain lengths are taken to first order, and turns as at rest.
struct TendonTerms {
    double energy = 0;        // [N mm]
    Points gradient;          // (p x 3) [N]
    Eigen::MatrixXd hessian;  // (3p x 3p) [N/mm], friction held
    TendonState state;
    Points lengthening;    // d(length)/dx (p x 3)
    double stiffness = 0;  // d tension / d length [N/mm]
    Points by_value;       // d gradient / d value (p x 3)
};

/// `x`: where the points are (p x 3). @throws InvalidInput for a path of less than two points, or with two in one place
TendonTerms tendon_terms(const TendonPull& pull, const Points& x, bool small_strain);

/// Friction by the turn: over a turn of the angle a the tension falls by exp(-mu a) in the direction in which the
/// tendon slides [Euler 1769; Eytelwein 1808]; where it does not, it is anything between that and exp(mu a) times as
/// much.
///
/// Segments keep their tension until it leaves this cone, which is exact where turns stay: with the values that a
/// tendon was set to one after the other, tension t_k = clamp(t_k, value exp(-mu a_k), value exp(mu a_k)), a_k all
/// turns up to segment k. By length values stand for the tensions that go with them.
TendonFriction tendon_friction(const TendonPull& pull, const Points& x, bool small_strain);

/// How forces follow friction's m numbers, the shares of all segments but the first and, by length, e; and these the
/// path: as forces have no potential then, d gradient / dx is hessian + by_number * number_by_point.
struct TendonSliding {
    Eigen::MatrixXd by_number;        // d gradient / d number (3p x m)
    Eigen::MatrixXd number_by_point;  // (m x 3p)
};
TendonSliding tendon_sliding(const TendonPull& pull, const Points& x, bool small_strain);

}  // namespace palpate::fem
