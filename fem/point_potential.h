#pragma once

#include <memory>
#include <string>
#include <vector>

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
    double energy = 0;              // [N mm per unit weight]
    Vec3 gradient = Vec3::Zero();   // d energy / d x
    Mat3 hessian = Mat3::Zero();    // d^2 energy / d x^2
    Eigen::Matrix3Xd by_parameter;  // d gradient / d parameter (3 x P); filled on demand
};

/// A physical effect as a potential on points of a body:
///   Pi = sum_i w_i e(X_i, x_i)
/// with X_i where a point rests and x_i where it stands. Written once, in force on every model of the body: finite
/// elements, spheres and links. One that acts on the support releases it: what was held is then held by the effect.
class PointPotential {
public:
    virtual ~PointPotential() = default;
    virtual ActsOn acts_on() const = 0;
    virtual PointTerms terms(const Vec3& X, const Vec3& x, bool with_parameters) const = 0;
};

using Potentials = std::vector<std::shared_ptr<const PointPotential>>;

/// Does one of them take the place of the supports?
inline bool release_supports(const Potentials& effects) {
    for (const auto& effect : effects) {
        if (effect->acts_on() == ActsOn::support) return true;
    }
    return false;
}

}  // namespace palpate::fem
