#pragma once

#include "fem/effects/known_effect.h"

namespace palpate::fem {

/// A rigid plane that the body's surface may touch, without friction, and not pass:
///   e = k/2 min(0, n.x - offset)^2 on its area,
/// n pointing from the plane to where the body is.
class ContactPlane : public PointPotential {
public:
    /// `n`: of any length above 0; `offset`: of the plane along n / |n| [mm]; `stiffness` k [N/mm^3], > 0.
    ContactPlane(const Vec3& n, double offset, double stiffness) : n_(n.normalized()), offset_(offset), k_(stiffness) {}
    ActsOn acts_on() const override { return ActsOn::surface; }
    PointTerms terms(const Vec3& X, const Vec3& x) const override;
    bool is_one_sided() const override { return true; }

private:
    Vec3 n_;
    double offset_, k_;
};

/// How files and users tell it.
KnownEffect known_contact();

}  // namespace palpate::fem
