#pragma once

#include "mesh/types.h"

namespace palpate::fem {

/// An energy density at a material point with deformation gradient F, as a share w of the shear modulus there, and its
/// derivatives by F.
struct MaterialTerms {
    using Second = Eigen::Matrix<double, 9, 9>;
    double w = 0;                    // [-]
    Mat3 first = Mat3::Zero();       // dw/dF
    Second second = Second::Zero();  // d^2 w / dF_ca dF_db at (3 c + a, 3 d + b), symmetric; filled on demand
};
inline MaterialTerms operator+(const MaterialTerms& a, const MaterialTerms& b) {
    return {a.w + b.w, a.first + b.first, a.second + b.second};
}

/// A physical effect in the material itself: what it adds to the body's law at a point, or how much stiffer it makes
/// it. The energy density at X becomes
///   s(X) (W(F) + mu w(X, F)),   W the law and mu its shear modulus.
/// Several effects multiply their s and add their w. Written once, in force on every model of the body: at the
/// quadrature points of finite elements, and in the fibres of a skeleton's links.
class MaterialEffect {
public:
    virtual ~MaterialEffect() = default;
    /// s(X), how many times as stiff the material is there; above 0.
    virtual double stiffness(const Vec3& /*X*/) const { return 1; }
    /// w(X, F) and its derivatives. @pre det F > 0.
    virtual MaterialTerms terms(const Vec3& /*X*/, const Mat3& /*F*/, bool /*with_second*/) const { return {}; }
    /// Is w zero everywhere, so that only s counts?
    virtual bool is_scale() const { return false; }
};

}  // namespace palpate::fem
