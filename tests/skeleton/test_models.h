#pragma once

#include <Eigen/Geometry>
#include <random>

#include "skeleton/model/attachment/attach.h"
#include "skeleton/statics/statics.h"

namespace palpate::skeleton::testing {

inline Model with_law(Model model, EquilibriumLaw law) {
    model.law = law;
    return model;
}

inline Vec3 random_vector(std::mt19937_64& engine, double size) {
    std::uniform_real_distribution<double> uniform(-size, size);
    const double x = uniform(engine), y = uniform(engine), z = uniform(engine);
    return {x, y, z};
}

inline Sphere sphere_at(const Vec3& center, bool held = false) {
    Sphere sphere;
    sphere.center = center;
    sphere.radius = 4;
    sphere.mass = 1e-6;
    sphere.inertia = 0.4 * sphere.mass * sphere.radius * sphere.radius * Mat3::Identity();
    sphere.held = held;
    return sphere;
}

inline void add_link(Model& model, int a, int b, const Vec3& stiffness) {
    Link link;
    link.a = a;
    link.b = b;
    link.length = (model.spheres[b].center - model.spheres[a].center).norm();
    link.stiffness = stiffness;
    model.links.push_back(link);
}

/// Spheres in a row, 10 mm apart, the first held.
inline Model make_chain(int links, const Vec3& direction = Vec3::UnitX(), const Vec3& stiffness = {2.0, 300.0, 200.0}) {
    Model model;
    for (int i = 0; i <= links; ++i) model.spheres.push_back(sphere_at(10.0 * i * direction.normalized(), i == 0));
    for (int i = 0; i < links; ++i) add_link(model, i, i + 1, stiffness);
    return model;
}

/// A block of n spheres each way, 10 mm apart and shaken, linked to their neighbours and across the faces' diagonals,
/// of random stiffness; held at x = 0.
inline Model make_lattice(const Eigen::Vector3i& n, std::uint64_t seed = 1) {
    std::mt19937_64 engine(seed);
    std::uniform_real_distribution<double> factor(0.5, 2.0);
    Model model;
    for (int k = 0; k < n.z(); ++k)
        for (int j = 0; j < n.y(); ++j)
            for (int i = 0; i < n.x(); ++i)
                model.spheres.push_back(sphere_at(10.0 * Vec3(i, j, k) + random_vector(engine, 1.5), i == 0));
    for (int a = 0; a < static_cast<int>(model.spheres.size()); ++a)
        for (int b = a + 1; b < static_cast<int>(model.spheres.size()); ++b)
            if ((model.spheres[b].center - model.spheres[a].center).norm() < 14.5) {
                const double e = factor(engine), f = factor(engine), t = factor(engine);
                add_link(model, a, b, Vec3(1.5 * e, 100 * f, 80 * t));
            }
    return model;
}

/// The same with full links, to the next neighbours alone, and volumes: of sections and cells that fill the block.
inline Model make_full_lattice(const Eigen::Vector3i& n, std::uint64_t seed = 1) {
    Model model = make_lattice(n, seed);
    std::erase_if(model.links, [](const Link& link) { return link.length > 13.2; });
    std::mt19937_64 engine(seed);
    std::uniform_real_distribution<double> factor(0.5, 2.0);
    for (Link& link : model.links) {
        const Vec3 X_a = model.spheres[link.a].center, X_b = model.spheres[link.b].center;
        const Vec3 along = (X_b - X_a).normalized(), across = along.unitOrthogonal();
        link.section.emplace();
        link.section->at = (X_a + X_b) / 2 + random_vector(engine, 1);
        link.section->axes << along.transpose(), across.transpose(), along.cross(across).transpose();
        link.section->area = 100;
        link.stiffness.resize(6);
        for (int s = 0; s < 6; ++s) link.stiffness[s] = (s >= 1 && s <= 3 ? 80 : 1.5) * factor(engine);
    }
    for (Sphere& sphere : model.spheres) {
        sphere.cell = 1000;
        sphere.volume = sphere.held ? 0 : 0.3 * factor(engine);
    }
    return model;
}

inline Attachment at_sphere(const Model& model, int sphere) {
    return on_sphere(model, sphere, model.spheres[sphere].center);
}

inline Load force_at(const Model& model, int sphere, const Vec3& force) {
    Load load;
    load.forces.push_back({at_sphere(model, sphere), force});
    return load;
}

/// A state far from rest: every sphere moved by up to `move` [mm] and turned by up to `turn` about each axis.
inline State random_state(const Model& model, std::mt19937_64& engine, double move, double turn) {
    Eigen::VectorXd step(model.dofs());
    for (int i = 0; i < static_cast<int>(model.spheres.size()); ++i) {
        step.segment<3>(6 * i) = random_vector(engine, move);
        step.segment<3>(6 * i + 3) = random_vector(engine, turn);
    }
    return advance(rest_state(model), step);
}

}  // namespace palpate::skeleton::testing
