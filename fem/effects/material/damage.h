#pragma once

#include "fem/effects/effects.h"

namespace palpate::fem {

/// What damage takes off the energy of distortion at a point, as a function of what that energy D would be without it
/// (a share of the shear modulus [-]), and its derivatives by D. As D_max less D counts, d first / d D_max is -second.
struct DamageTerms {
    double energy = 0, first = 0, second = 0;
};

/// The Mullins effect as a pseudo-elastic law [Ogden & Roxburgh 1999]: on its way to the greatest D that a point has
/// ever borne, D_max, its stress is that of the material without damage; below it is eta times as large,
///   eta(D) = 1 - share erf((D_max - D) / m),   m = 3/2 strain^2,
/// which is 1 where D_max is reached again, so that the first curve is gone on with. D = 3/2 e^2 at the equivalent
/// strain e, so `strain` is that whose D is m: a point that bore it is softer by share erf(1) = 0.84 share at rest.
///
/// eta depends on D alone, so what acts between two states is elastic. With
///   int_0^x erf = x erf x + (exp(-x^2) - 1) / sqrt(pi) =: I(x),   x = (D_max - D) / m, 0 beyond D_max,
/// the energy is D less share m (I(D_max / m) - I(x)). Never below (1 - share) D, and as convex in D: dead loads that
/// the undamaged body bears are borne. [Simo 1987] would soften the first curve too, and is less apart from a softer
/// modulus. Over a cycle share m mu I(D_max / m) is lost.
DamageTerms damage_energy(const Damage& damage, double most, double D);

}  // namespace palpate::fem
