#pragma once

#include "fem/effects/known_effect.h"

namespace palpate::fem {

/// A material that stiffens as it is strained: w = c2 x^2 + c3 x^3 with x = J^-2/3 tr F^T F - 3, after the law's own
/// mu/2 x. With the neo-Hookean law that is Yeoh's, C20 = c2 mu and C30 = c3 mu. [Yeoh 1990]
class Stiffening : public MaterialEffect {
public:
    Stiffening(double c2, double c3) : c2_(c2), c3_(c3) {}  // [-]
    MaterialTerms terms(const Vec3& X, const Mat3& F, bool with_second) const override;

private:
    double c2_, c3_;
};

/// How files and users tell it.
KnownEffect known_stiffening();

}  // namespace palpate::fem
