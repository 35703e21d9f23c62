#pragma once

#include <vector>

#include "fem/effects/known_effect.h"

namespace palpate::fem {

/// A family of fibres that resists being stretched and pressed.
struct Fibre {
    double k = 0;            // its modulus as a share of the shear modulus [-]
    Vec3 n = Vec3::UnitX();  // its direction at rest; of any length above 0
};

/// A material that is stiffer along fibres: w = sum_i k_i/2 (n_i . E n_i)^2 with E = (F^T F - I) / 2. One family makes
/// it transversely isotropic, two or three, at right angles or not, orthotropic and beyond.
class Anisotropy : public MaterialEffect {
public:
    explicit Anisotropy(std::vector<Fibre> fibres);
    MaterialTerms terms(const Vec3& X, const Mat3& F, bool with_second) const override;

private:
    std::vector<Fibre> fibres_;  // of unit directions
};

/// How files and users tell it.
KnownEffect known_anisotropy();

}  // namespace palpate::fem
