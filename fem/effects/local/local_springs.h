#pragma once

#include "fem/effects/known_effect.h"
#include "fem/effects/local/locality.h"

namespace palpate::fem {

/// Something holds a part of the skin: springs of stiffness k in all to where it rests, e = k/2 |x - X|^2, spread over
/// the part by its area.
class LocalSprings : public PointPotential {
public:
    LocalSprings(const Locality& where, double k) : where_(where), k_(k) {}  // [N/mm]
    ActsOn acts_on() const override { return ActsOn::surface; }
    PointTerms terms(const Vec3& X, const Vec3& x) const override;
    Eigen::VectorXd weights(const Points& rest, const Eigen::VectorXd& even) const override {
        return where_.shares(rest, even);
    }

private:
    Locality where_;
    double k_;
};

/// How files and users tell it.
KnownEffect known_local_springs();

}  // namespace palpate::fem
