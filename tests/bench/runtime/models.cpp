#include "tests/bench/runtime/models.h"

#include <algorithm>
#include <numeric>
#include <random>

#include "skeleton/model/attachment/attach.h"
#include "skeleton/statics/equilibrium.h"
#include "skeleton/statics/statics.h"

namespace palpate::bench {

namespace {

// Silicone: E = 0.1 MPa, 1000 kg/m^3; a sphere stands for a cube of 10 mm.
constexpr double spacing = 10, young = 0.1, shear = young / 3;

skeleton::Sphere cube_at(const Vec3& center, bool held, bool full) {
    skeleton::Sphere sphere;
    sphere.center = center;
    sphere.radius = spacing / 2;
    sphere.mass = 1e-9 * spacing * spacing * spacing;
    sphere.inertia = sphere.mass * spacing * spacing / 6 * Mat3::Identity();
    sphere.held = held;
    if (full) {
        sphere.cell = spacing * spacing * spacing;
        sphere.volume = held ? 0 : 4 * shear;
    }
    return sphere;
}

void join(skeleton::Model& model, int a, int b, bool full) {
    skeleton::Link link;
    link.a = a;
    link.b = b;
    const Vec3 X_a = model.spheres[a].center, X_b = model.spheres[b].center;
    link.length = (X_b - X_a).norm();
    const double area = spacing * spacing, inertia = area * area / 12, L = link.length;
    if (!full) {
        link.stiffness = Vec3(young * area / L, 2 * young * inertia / L, 2 * shear * inertia / L);
        model.links.push_back(link);
        return;
    }
    link.stiffness.resize(6);
    link.stiffness << young * area / L, young * inertia / L, 2 * shear * inertia / L, young * inertia / L,
        shear * area / L, shear * area / L;
    const Vec3 along = (X_b - X_a).normalized(), across = along.unitOrthogonal();
    link.section.emplace();
    link.section->at = (X_a + X_b) / 2;
    link.section->axes << along.transpose(), across.transpose(), along.cross(across).transpose();
    link.section->area = area;
    model.links.push_back(link);
}

}  // namespace

skeleton::Model chain(int links, bool full) {
    skeleton::Model model;
    for (int i = 0; i <= links; ++i) model.spheres.push_back(cube_at({spacing * i, 0, 0}, i == 0, full));
    for (int i = 0; i < links; ++i) join(model, i, i + 1, full);
    return model;
}

skeleton::Model lattice(const Eigen::Vector3i& n, bool full) {
    skeleton::Model model;
    const auto index = [&](int i, int j, int k) { return (i * n.y() + j) * n.z() + k; };
    for (int i = 0; i < n.x(); ++i)
        for (int j = 0; j < n.y(); ++j)
            for (int k = 0; k < n.z(); ++k) model.spheres.push_back(cube_at(spacing * Vec3(i, j, k), i == 0, full));
    for (int i = 0; i < n.x(); ++i)
        for (int j = 0; j < n.y(); ++j)
            for (int k = 0; k < n.z(); ++k) {
                if (i + 1 < n.x()) join(model, index(i, j, k), index(i + 1, j, k), full);
                if (j + 1 < n.y()) join(model, index(i, j, k), index(i, j + 1, k), full);
                if (k + 1 < n.z()) join(model, index(i, j, k), index(i, j, k + 1), full);
            }
    return model;
}

skeleton::Model shuffled(skeleton::Model model) {
    std::mt19937_64 engine(1);
    std::vector<int> place(model.spheres.size());
    std::iota(place.begin(), place.end(), 0);
    std::ranges::shuffle(place, engine);
    skeleton::Model result = model;
    for (std::size_t i = 0; i < place.size(); ++i) result.spheres[place[i]] = model.spheres[i];
    for (skeleton::Link& link : result.links) {
        link.a = place[link.a];
        link.b = place[link.b];
    }
    std::ranges::shuffle(result.links, engine);
    return result;
}

skeleton::Model free(skeleton::Model model) {
    for (skeleton::Sphere& sphere : model.spheres) sphere.held = false;
    return model;
}

skeleton::Model organ(int spheres, int halvings) {
    // Cubes that fill an ellipsoid with half axes 2 : 1.4 : 1, in the volume of so many.
    const double unit = std::cbrt(spheres * 3 / (4 * 3.14159265 * 2 * 1.4));
    const Vec3 half = unit * Vec3(2, 1.4, 1);
    skeleton::Model model;
    std::vector<Eigen::Vector3i> cells;
    for (int i = -20; i <= 20; ++i)
        for (int j = -20; j <= 20; ++j)
            for (int k = -20; k <= 20; ++k)
                if (Vec3(i, j, k).cwiseQuotient(half).squaredNorm() < 1) cells.emplace_back(i, j, k);
    for (const Eigen::Vector3i& c : cells) {
        model.spheres.push_back(cube_at(spacing * c.cast<double>(), c.x() < -1.5 * unit, true));
    }
    for (int a = 0; a < static_cast<int>(cells.size()); ++a)
        for (int b = a + 1; b < static_cast<int>(cells.size()); ++b)
            if ((cells[a] - cells[b]).squaredNorm() == 1) join(model, a, b, true);

    model.surface = mesh::make_sphere(Vec3::Zero(), 1, halvings);
    const Points points = model.surface.vertices;
    model.surface.vertices = points * (spacing * (half.array() + 0.3)).matrix().asDiagonal();
    std::mt19937_64 engine(3);
    std::normal_distribution<double> normal;
    for (const auto& vertex : model.surface.vertices.rowwise()) {
        const Vec3 at = vertex.transpose();
        std::vector<int> near(model.spheres.size());
        std::iota(near.begin(), near.end(), 0);
        std::ranges::partial_sort(near, near.begin() + 6, {},
                                  [&](int i) { return (model.spheres[i].center - at).squaredNorm(); });
        skeleton::Attachment point{{}, at};
        double sum = 0;
        for (int n = 0; n < 6; ++n) {
            const double d = (model.spheres[near[n]].center - at).norm() / (0.45 * spacing);
            point.shares.push_back({.sphere = near[n], .weight = std::exp(-0.5 * d * d) + 1e-6});
            sum += point.shares.back().weight;
        }
        for (skeleton::SphereInfluence& share : point.shares) {
            share.weight /= sum;
            share.follow << share.weight * Mat3::Identity(),
                -share.weight * skeleton::skew(at - model.spheres[share.sphere].center);
            for (double& entry : share.follow.reshaped()) entry += 0.02 * normal(engine);
        }
        model.skin.push_back(point);
    }
    return model;
}

skeleton::Model with_skin_on_spheres(skeleton::Model model) {
    const auto n = static_cast<Eigen::Index>(model.spheres.size());
    model.surface.vertices.resize(3 * n, 3);
    model.surface.triangles.resize(n, 3);
    for (Eigen::Index i = 0; i < n; ++i) {
        model.surface.triangles.row(i) << static_cast<int>(3 * i), static_cast<int>(3 * i + 1),
            static_cast<int>(3 * i + 2);
        for (int c = 0; c < 3; ++c) {
            const Vec3 at = model.spheres[i].center + spacing / 2 * Vec3::Unit(c);
            model.surface.vertices.row(3 * i + c) = at.transpose();
            model.skin.push_back(skeleton::on_sphere(model, static_cast<int>(i), at));
        }
    }
    return model;
}

Vec3 force_for(const skeleton::Model& model, double share) {
    skeleton::Load load;
    const Vec3 direction = Vec3(1, 2, 3).normalized();
    load.forces.push_back({model.skin.back(), direction});
    skeleton::Model linear = model;
    linear.law = skeleton::EquilibriumLaw::linear;
    const skeleton::Equilibrium by_one = skeleton::equilibrium(linear, load);
    const double size = mesh::bounding_box(model.surface.vertices).longest_side();
    return share * size / by_one.step.tail<6>().head<3>().norm() * direction;
}

void set_off(runtime::Body& body, double speed, double spin) {
    std::mt19937_64 engine(4);
    std::uniform_real_distribution<double> uniform(-1, 1);
    const auto vector = [&](double size) { return Vec3(size * Vec3::NullaryExpr([&] { return uniform(engine); })); };
    for (int i = 0; i < body.sphere_count(); ++i) {
        const Vec3 v = vector(speed), w = vector(spin);
        body.set_velocity(i, v, w);
    }
}

}  // namespace palpate::bench
