#pragma once

#include "mesh/types.h"

namespace palpate::fem {

/// Which points of a body an effect acts on, and what they weigh.
enum class ActsOn {
    material,  // all of the body; weights are masses [tonne]
    surface,   // its skin; weights are areas [mm^2]
    support,   // what stands in a support; weights are shares of it, they add up to 1
};

/// A potential at one point, at unit weight, and its derivatives by where the point stands.
struct PointTerms {
    double energy = 0;             // [N mm per unit weight]
    Vec3 gradient = Vec3::Zero();  // d energy / d x
    Mat3 hessian = Mat3::Zero();   // d^2 energy / d x^2
};

/// A physical effect as a potential on points of a body:
///   Pi = sum_i w_i e(X_i, x_i)
/// with X_i where a point rests and x_i where it stands. Written once, in force on every model of the body: finite
/// elements, spheres and links. One that acts on the support releases it: what was held is then held by the effect.
class PointPotential {
public:
    virtual ~PointPotential() = default;
    virtual ActsOn acts_on() const = 0;
    virtual PointTerms terms(const Vec3& X, const Vec3& x) const = 0;
    /// What the points weigh for this effect: as the body says, unless it is spread unevenly over them. `rest`: where
    /// they rest (n x 3) [mm].
    virtual Eigen::VectorXd weights(const Points& rest, const Eigen::VectorXd& even) const;
    /// Does it act on one side only, as a wall does? Then small strain does not make it linear: a law that takes
    /// effects as they are at rest, to second order, takes this one as it stands.
    virtual bool is_one_sided() const { return false; }
};

inline Eigen::VectorXd PointPotential::weights(const Points&, const Eigen::VectorXd& even) const { return even; }

}  // namespace palpate::fem
