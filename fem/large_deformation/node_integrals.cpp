#include "fem/large_deformation/node_integrals.h"

#include <Eigen/Geometry>
#include <Eigen/LU>

#include "fem/elements/shape.h"

namespace palpate::fem {

namespace {

/// A point of a quadrature rule on the triangle; weights add up to 1.
struct TrianglePoint {
    Vec3 l;
    double weight;
};

/// Exact to degree 5, as many as curved faces ask for. [Radon 1948]
std::array<TrianglePoint, 7> triangle_rule() {
    const double root = std::sqrt(15.0);
    std::array<TrianglePoint, 7> rule;
    rule[0] = {Vec3::Constant(1.0 / 3), 9.0 / 40};
    for (int k = 0; k < 3; ++k) {
        for (const int sign : {-1, 1}) {
            const double a = (6 + sign * root) / 21;
            TrianglePoint& point = rule[sign < 0 ? 1 + k : 4 + k];
            point = {Vec3::Constant(a), (155 + sign * root) / 1200};
            point.l(k) = 1 - 2 * a;
        }
    }
    return rule;
}

}  // namespace

NodeIntegrals node_integrals(const mesh::VolumeMesh& mesh, const std::vector<char>& held) {
    const Eigen::Index n = mesh.nodes.rows();
    NodeIntegrals result{Eigen::VectorXd::Zero(n), Eigen::VectorXd::Zero(n), Eigen::VectorXd::Zero(n)};

    const auto solid_rule = quadrature_5();
    for (Eigen::Index e = 0; e < mesh.tetrahedra.rows(); ++e) {
        const auto element = mesh.tetrahedra.row(e);
        const auto X = node_positions<10>(mesh.nodes, element);
        for (const auto& [l, weight] : solid_rule) {
            const Mat3 J = X.transpose() * shape_gradient<4, 10>(l);
            const double dV = weight / 6 * J.determinant();
            const auto N = shape<4, 10>(l);
            for (int i = 0; i < 10; ++i) {
                result.volume(element(i)) += dV * N(i);
                if (held[element(i)]) result.support(element(i)) += dV * N(i) * N(i);
            }
        }
    }
    result.support /= result.support.sum();

    const auto face_rule = triangle_rule();
    for (Eigen::Index f = 0; f < mesh.faces.rows(); ++f) {
        const auto face = mesh.faces.row(f);
        const auto X = node_positions<6>(mesh.nodes, face);
        for (const auto& [l, weight] : face_rule) {
            const Eigen::Matrix<double, 3, 2> tangents = X.transpose() * shape_gradient<3, 6>(l);
            const double dA = weight / 2 * tangents.col(0).cross(tangents.col(1)).norm();
            const auto N = shape<3, 6>(l);
            for (int i = 0; i < 6; ++i) result.area(face(i)) += dA * N(i);
        }
    }
    return result;
}

}  // namespace palpate::fem
