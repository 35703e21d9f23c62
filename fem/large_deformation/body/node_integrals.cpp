#include "fem/large_deformation/body/node_integrals.h"

#include <Eigen/Geometry>
#include <Eigen/LU>

#include "fem/elements/shape.h"

namespace palpate::fem {

NodeIntegrals node_integrals(const mesh::VolumeMesh& mesh, const std::vector<char>& held,
                             const ElementRegions& regions) {
    const Eigen::Index n = mesh.nodes.rows();
    NodeIntegrals result{Eigen::VectorXd::Zero(n), Eigen::VectorXd::Zero(n), Eigen::VectorXd::Zero(n),
                         Eigen::VectorXd::Zero(n)};
    for (Eigen::Index i = 0; i < n; ++i) result.support(i) = held[i] ? 1 : 0;
    result.support /= result.support.sum();

    const auto solid_rule = quadrature_5();
    for (Eigen::Index e = 0; e < mesh.tetrahedra.rows(); ++e) {
        const auto element = mesh.tetrahedra.row(e);
        const auto X = node_positions<10>(mesh.nodes, element);
        const std::size_t group = regions.group(static_cast<std::size_t>(e));
        const double density = group == 0 ? 1 : regions.density[group - 1];
        for (const auto& [l, weight] : solid_rule) {
            const Mat3 J = X.transpose() * shape_gradient<4, 10>(l);
            const double dV = weight / 6 * J.determinant();
            const auto N = shape<4, 10>(l);
            for (int i = 0; i < 10; ++i) {
                result.volume(element(i)) += dV * N(i);
                result.mass(element(i)) += density * dV * N(i);
            }
        }
    }

    const auto face_rule = triangle_quadrature_5();
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
