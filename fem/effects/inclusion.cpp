#include "fem/effects/inclusion.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace palpate::fem {

Inclusion::Inclusion(Shape shape, const Vec3& centre, const Vec3& half_widths, double ratio)
    : shape_(shape), centre_(centre), half_widths_(half_widths), log_ratio_(std::log(ratio)) {
    assert(ratio > 0 && half_widths.minCoeff() > 0);
}

Inclusion Inclusion::sphere(const Vec3& centre, double radius, double ratio) {
    return {Shape::sphere, centre, Vec3::Constant(radius), ratio};
}

Inclusion Inclusion::box(const Vec3& centre, const Vec3& half_widths, double ratio) {
    return {Shape::box, centre, half_widths, ratio};
}

double Inclusion::stiffness(const Vec3& X) const {
    const Vec3 off = (X - centre_).cwiseQuotient(half_widths_);
    const double d = shape_ == Shape::sphere ? off.norm() : off.cwiseAbs().maxCoeff();
    return std::exp(log_ratio_ * std::clamp((1.15 - d) / 0.3, 0.0, 1.0));
}

}  // namespace palpate::fem
