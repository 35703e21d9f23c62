#pragma once

#include "skeleton/effects/effect.h"

namespace palpate::skeleton {

/// A support that gives way: springs of stiffness k in all, spread evenly over what it holds, e = k/2 |x - X|^2.
class CompliantSupport : public fem::PointPotential {
public:
    explicit CompliantSupport(double k) : k_(k) {}  // [N/mm]
    fem::ActsOn acts_on() const override { return fem::ActsOn::support; }
    fem::PointTerms terms(const Vec3& X, const Vec3& x) const override;

private:
    double k_;
};

}  // namespace palpate::skeleton
