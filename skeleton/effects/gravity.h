#pragma once

#include "skeleton/effects/effect.h"

namespace palpate::skeleton {

/// The weight of the body: e = -g . (x - X) on its masses.
class Gravity : public fem::PointPotential {
public:
    explicit Gravity(const Vec3& g) : g_(g) {}  // [mm/s^2]
    fem::ActsOn acts_on() const override { return fem::ActsOn::material; }
    fem::PointTerms terms(const Vec3& X, const Vec3& x) const override;

private:
    Vec3 g_;
};

}  // namespace palpate::skeleton
