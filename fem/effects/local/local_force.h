#pragma once

#include "fem/effects/known_effect.h"
#include "fem/effects/local/locality.h"

namespace palpate::fem {

/// A constant force F on the material of a part of the body, the same however the body moves: e = -F . (x - X), spread
/// over the part by its mass.
class LocalForce : public PointPotential {
public:
    LocalForce(const Locality& where, const Vec3& force) : where_(where), force_(force) {}  // [N]
    ActsOn acts_on() const override { return ActsOn::material; }
    PointTerms terms(const Vec3& X, const Vec3& x) const override;
    Eigen::VectorXd weights(const Points& rest, const Eigen::VectorXd& even) const override {
        return where_.shares(rest, even);
    }

private:
    Locality where_;
    Vec3 force_;
};

/// How files and users tell it.
KnownEffect known_local_force();

}  // namespace palpate::fem
