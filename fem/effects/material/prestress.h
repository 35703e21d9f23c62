#pragma once

#include "fem/effects/known_effect.h"

namespace palpate::fem {

/// A material that is under stress at rest: w = S:E with E = (F^T F - I) / 2, S the second Piola-Kirchhoff stress there
/// over the shear modulus [-], symmetric. It turns with the body.
class Prestress : public MaterialEffect {
public:
    explicit Prestress(const Mat3& S);
    MaterialTerms terms(const Vec3& X, const Mat3& F, bool with_second) const override;

private:
    Mat3 S_;
};

/// How files and users tell it.
KnownEffect known_prestress();

}  // namespace palpate::fem
