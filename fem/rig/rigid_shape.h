#pragma once

#include "mesh/types.h"

namespace palpate::fem {

/// How far a point is from a rigid shape, below 0 inside of it, and the derivatives by where the point is.
struct Gap {
    double value = 0;             // [mm]
    Vec3 normal = Vec3::Zero();   // d value / d y: the way out, unit but on the slope over a punch's rim
    Mat3 hessian = Mat3::Zero();  // d^2 value / d y^2 [1/mm]
};

/// A rigid body that others may touch, by its signed distance.
class RigidShape {
public:
    virtual ~RigidShape() = default;
    /// `y`: where the point is when the tool is at rest [mm].
    virtual Gap gap(const Vec3& y) const = 0;
    /// The same for a point of a body that, if it had not moved, would be at `rest`: this tells where a point that is
    /// deep within, as on the way to an equilibrium, came in.
    virtual Gap gap(const Vec3& y, const Vec3& /*rest*/) const { return gap(y); }
    /// About the radius of what it presses with [mm].
    virtual double radius() const = 0;
};

}  // namespace palpate::fem
