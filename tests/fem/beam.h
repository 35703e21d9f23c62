#pragma once

#include <Eigen/Geometry>

#include "bodies.h"
#include "fem/hyperelastic_body.h"

namespace palpate::fem {

inline constexpr std::array laws{MaterialLaw::linear, MaterialLaw::svk, MaterialLaw::neo_hookean};
inline constexpr std::array dilatations{Dilatation::mean, Dilatation::full, Dilatation::thin};

/// A straight bar [0, size] of quadratic elements, held at x = 0.
struct Beam {
    Vec3 size;
    mesh::VolumeMesh mesh;
    std::vector<char> held;

    Beam(const Vec3& measures, const Eigen::Vector3i& cells)
        : size(measures),
          mesh(mesh::to_quadratic(mesh::make_bar(Vec3::Zero(), measures, cells))),
          held(nodes_where(mesh, [](const Vec3& x) { return x.x() < 1e-9; })) {}
    HyperelasticBody body(Dilatation dilatation = Dilatation::mean) const { return {mesh, held, dilatation}; }

    /// Nodal forces of a traction t [MPa] on the face at x: a third of each triangle's share on its midsides.
    Eigen::VectorXd traction(double x, const Vec3& t) const {
        Eigen::VectorXd f = Eigen::VectorXd::Zero(mesh.nodes.size());
        for (Eigen::Index k = 0; k < mesh.faces.rows(); ++k) {
            const Points corners = mesh.nodes(mesh.faces.row(k), Eigen::all);
            if ((corners.col(0).array() - x).abs().maxCoeff() > 1e-9) continue;
            const Vec3 a = corners.row(1) - corners.row(0), b = corners.row(2) - corners.row(0);
            for (int m = 3; m < 6; ++m) f.segment<3>(3 * mesh.faces(k, m)) += a.cross(b).norm() / 6 * t;
        }
        return f;
    }
    Eigen::VectorXd end_force(const Vec3& force) const { return traction(size.x(), force / (size.y() * size.z())); }
    /// Nodal forces of a pull [MPa] at both ends.
    Eigen::VectorXd pull(double stress) const {
        return traction(size.x(), Vec3(stress, 0, 0)) + traction(0, Vec3(-stress, 0, 0));
    }

    /// Mean displacement of the nodes at the end.
    Vec3 tip(const Eigen::VectorXd& u) const {
        Vec3 sum = Vec3::Zero();
        int count = 0;
        for (Eigen::Index i = 0; i < mesh.nodes.rows(); ++i) {
            if (mesh.nodes(i, 0) < size.x() - 1e-9) continue;
            sum += u.segment<3>(3 * i);
            ++count;
        }
        return sum / count;
    }
};

inline double relative(const Eigen::VectorXd& a, const Eigen::VectorXd& b) { return (a - b).norm() / b.norm(); }

/// Random, of up to a given size in each component.
inline Eigen::VectorXd scatter(Eigen::Index size, double amount, unsigned seed = 3) {
    std::mt19937 engine(seed);
    std::uniform_real_distribution<double> uniform(-amount, amount);
    return Eigen::VectorXd::NullaryExpr(size, [&] { return uniform(engine); });
}

/// Central differences of a scalar or vector function by each component of u, a column each.
template <class Function>
Eigen::MatrixXd differences(Function&& value, const Eigen::VectorXd& u, double h) {
    Eigen::MatrixXd result;
    for (Eigen::Index k = 0; k < u.size(); ++k) {
        Eigen::VectorXd ahead = u, behind = u;
        ahead(k) += h;
        behind(k) -= h;
        const Eigen::VectorXd change = (value(ahead) - value(behind)) / (2 * h);
        if (k == 0) result.resize(change.size(), u.size());
        result.col(k) = change;
    }
    return result;
}

}  // namespace palpate::fem
