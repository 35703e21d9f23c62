#pragma once

#include "fem/effects/material/material_effect.h"
#include "skeleton/links/fibres/link_fibre.h"

namespace palpate::skeleton {

/// What a material effect adds to a fibre at X along the unit direction n, stretched by lambda at constant volume:
///   w(lambda) = w(X, F),  F = lambda n n^T + lambda^(-1/2) (I - n n^T),
/// a share of the shear modulus [-]. `second` on demand. @pre lambda > 0.
StretchTerms uniaxial(const fem::MaterialEffect& effect, const Vec3& X, const Vec3& n, double lambda, bool with_second);

}  // namespace palpate::skeleton
