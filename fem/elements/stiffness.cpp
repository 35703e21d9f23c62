#include "fem/elements/stiffness.h"

#include <Eigen/LU>
#include <numeric>

#include "fem/elements/assembly.h"
#include "fem/elements/shape.h"

namespace palpate::fem {

namespace {

template <int nodes>
Eigen::VectorXd gravity_of(const mesh::VolumeMesh& mesh, double density, const Vec3& g) {
    const auto rule = quadrature_5();
    Eigen::VectorXd load = Eigen::VectorXd::Zero(mesh.nodes.size());
    for (Eigen::Index e = 0; e < mesh.tetrahedra.rows(); ++e) {
        const auto element = mesh.tetrahedra.row(e);
        const auto X = node_positions<nodes>(mesh.nodes, element);
        Eigen::Matrix<double, nodes, 1> share = Eigen::Matrix<double, nodes, 1>::Zero();
        for (const auto& [l, weight] : rule) {
            const Mat3 J = X.transpose() * shape_gradient<4, nodes>(l);
            share += weight / 6 * J.determinant() * shape<4, nodes>(l);
        }
        for (int i = 0; i < nodes; ++i) {
            load.segment<3>(3 * static_cast<Eigen::Index>(element(i))) += density * share(i) * g;
        }
    }
    return load;
}

}  // namespace

SparseMatrix stiffness(const mesh::VolumeMesh& mesh, const Material& material, Dilatation dilatation) {
    std::vector<int> number(mesh.nodes.rows());
    std::iota(number.begin(), number.end(), 0);
    return assemble<int>(mesh, {.body = material}, dilatation, number, Half::both);
}

Eigen::VectorXd gravity_load(const mesh::VolumeMesh& mesh, double density, const Vec3& g) {
    return mesh.is_quadratic() ? gravity_of<10>(mesh, density, g) : gravity_of<4>(mesh, density, g);
}

}  // namespace palpate::fem
