#pragma once

#include "fem/effects/known_effect.h"

namespace palpate::fem {

/// The weight of the body: e = -g . (x - X) on its masses.
class Gravity : public PointPotential {
public:
    explicit Gravity(const Vec3& g) : g_(g) {}  // [mm/s^2]
    const Vec3& g() const { return g_; }
    ActsOn acts_on() const override { return ActsOn::material; }
    PointTerms terms(const Vec3& X, const Vec3& x) const override;

private:
    Vec3 g_;
};

/// How files and users tell it.
KnownEffect known_gravity();

}  // namespace palpate::fem
