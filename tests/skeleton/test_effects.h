#pragma once

#include <cmath>

#include "mesh/errors.h"
#include "test_models.h"

namespace palpate::skeleton::testing {

inline EffectRecord gravity(const Vec3& g) {
    return {"gravity", {{"gx", g.x(), "mm/s^2"}, {"gy", g.y(), "mm/s^2"}, {"gz", g.z(), "mm/s^2"}}};
}

inline EffectRecord compliant_support(double stiffness) {
    return {"compliant-support", {{"stiffness", stiffness, "N/mm"}}};
}

inline Model with_effects(Model model, std::vector<EffectRecord> effects) {
    model.effects = std::move(effects);
    return model;
}

/// A potential on the skin that no file knows: e = a/2 |u|^2 + b exp(n . u), u = x - X.
class Slope : public fem::PointPotential {
public:
    Slope(double a, double b) : a_(a), b_(b) {}
    fem::ActsOn acts_on() const override { return fem::ActsOn::surface; }
    fem::PointTerms terms(const Vec3& X, const Vec3& x) const override {
        const Vec3 u = x - X, n(0.1, -0.05, 0.02);
        const double e = std::exp(n.dot(u));
        return {.energy = 0.5 * a_ * u.squaredNorm() + b_ * e,
                .gradient = a_ * u + b_ * e * n,
                .hessian = a_ * Mat3::Identity() + b_ * e * n * n.transpose()};
    }

private:
    double a_, b_;
};

/// A lattice in a box of skin, which hangs on links, on spheres, and once on two spheres that no link joins.
inline Model lattice_with_skin() {
    Model model = make_lattice({4, 2, 2});
    model.surface = mesh::make_box({-4, -4, -4}, {34, 14, 14}, {4, 4, 4});
    for (const auto& vertex : model.surface.vertices.rowwise())
        model.skin.push_back(attach_to_links(model, vertex.transpose()));
    model.skin[5] = between(model, 0, 15, 0.4, model.skin[5].rest);
    model.supports = {mesh::PlaneRegion{{-4, 0, 0}, {1, 0, 0}, 0.1}};
    return model;
}

/// With a hollow sphere in its skin besides.
inline Model with_cavity(Model model, const Vec3& center, double radius) {
    const mesh::Surface wall = mesh::make_sphere(center, radius, 1);
    mesh::Surface& skin = model.surface;
    const Eigen::Index n = skin.vertices.rows(), m = skin.triangles.rows();
    skin.vertices.conservativeResize(n + wall.vertices.rows(), 3);
    skin.vertices.bottomRows(wall.vertices.rows()) = wall.vertices;
    skin.triangles.conservativeResize(m + wall.triangles.rows(), 3);
    skin.triangles.bottomRows(wall.triangles.rows()) = wall.triangles.rowwise().reverse().array() + static_cast<int>(n);
    for (const auto& vertex : wall.vertices.rowwise()) model.skin.push_back(attach_to_links(model, vertex.transpose()));
    return model;
}

}  // namespace palpate::skeleton::testing
