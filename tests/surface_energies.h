#pragma once

#include "fem/effects/surface/surface_energy.h"

namespace palpate {

/// Surface tension: gamma [N/mm] per area as it stands.
class Tension : public fem::SurfaceEnergy {
public:
    explicit Tension(double gamma) : gamma_(gamma) {}
    fem::AreaTerms terms(const Vec3& /*X*/, double J) const override { return {gamma_ * J, gamma_, 0}; }

private:
    double gamma_;
};

/// A skin that resists a change of its area: k/2 (J - 1)^2, k [N/mm]. [Evans & Skalak 1980]
class AreaSpring : public fem::SurfaceEnergy {
public:
    explicit AreaSpring(double k) : k_(k) {}
    fem::AreaTerms terms(const Vec3& /*X*/, double J) const override {
        return {k_ / 2 * (J - 1) * (J - 1), k_ * (J - 1), k_};
    }

private:
    double k_;
};

}  // namespace palpate
