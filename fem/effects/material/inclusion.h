#pragma once

#include "fem/effects/known_effect.h"

namespace palpate::fem {

/// A part of the body that is stiffer or softer than the rest, a sphere or a box along the axes, with a border that is
/// smooth so that answers follow its place:
///   s(X) = ratio^clamp((1.15 - d) / 0.3, 0, 1)
/// with d = |X - centre| / radius, or max_i |X_i - centre_i| / h_i for half widths h.
class Inclusion : public MaterialEffect {
public:
    static Inclusion sphere(const Vec3& centre, double radius, double ratio);  // [mm], [mm] > 0, [-] > 0
    static Inclusion box(const Vec3& centre, const Vec3& half_widths, double ratio);
    double stiffness(const Vec3& X) const override;
    bool is_scale() const override { return true; }

private:
    enum class Shape { sphere, box };
    Inclusion(Shape shape, const Vec3& centre, const Vec3& half_widths, double ratio);

    Shape shape_;
    Vec3 centre_, half_widths_;
    double log_ratio_;
};

/// How files and users tell it.
KnownEffect known_inclusion();

}  // namespace palpate::fem
