#pragma once

#include "fem/effects/known_effect.h"

namespace palpate::fem {

/// A support that gives way: springs of stiffness k in all over what it holds, e = k/2 |x - X|^2.
///
/// `turning`: how stiffly it turns, over springs that are spread evenly. Above 1 they stand closer to the rim, below it
/// to the middle: their shares are w (1 + s (r^2 / <r^2> - 1)), r the distance from their centre, and s such that the
/// second moment is that many times as large. Points that are all as far from the centre share as they did.
class CompliantSupport : public PointPotential {
public:
    explicit CompliantSupport(double k, double turning = 1) : k_(k), turning_(turning) {}  // [N/mm], [-]
    ActsOn acts_on() const override { return ActsOn::support; }
    PointTerms terms(const Vec3& X, const Vec3& x) const override;
    Eigen::VectorXd weights(const Points& rest, const Eigen::VectorXd& even) const override;

private:
    double k_, turning_;
};

/// How files and users tell it.
KnownEffect known_compliant_support();

}  // namespace palpate::fem
