#pragma once

#include "fem/effects/point/point_potential.h"

namespace palpate::fem {

/// -g.x: a body's weight in the field g [mm/s^2].
struct Weight final : PointPotential {
    Vec3 g;
    explicit Weight(const Vec3& field) : g(field) {}
    ActsOn acts_on() const override { return ActsOn::material; }
    PointTerms terms(const Vec3&, const Vec3& x) const override { return {-g.dot(x), -g, Mat3::Zero()}; }
};

/// k/2 d^2 + q/4 d^4, d the way from where the point rests.
struct Springs final : PointPotential {
    ActsOn on;
    double k, q;
    Springs(ActsOn what, double linear, double cubic) : on(what), k(linear), q(cubic) {}
    ActsOn acts_on() const override { return on; }
    PointTerms terms(const Vec3& X, const Vec3& x) const override {
        const Vec3 d = x - X;
        const double d2 = d.squaredNorm();
        return {k / 2 * d2 + q / 4 * d2 * d2, (k + q * d2) * d,
                (k + q * d2) * Mat3::Identity() + 2 * q * d * d.transpose()};
    }
};

}  // namespace palpate::fem
