#include "fem/large_deformation/elements/element_shape.h"

#include <fmt/format.h>

#include <Eigen/LU>

#include "fem/elements/shape.h"
#include "mesh/errors.h"

namespace palpate::fem {

std::vector<ElementShape> element_shapes(const mesh::VolumeMesh& mesh) {
    if (!mesh.is_quadratic()) {
        throw InvalidInput(
            fmt::format("The elements of the volume mesh have {} nodes; large deformation needs quadratic "
                        "tetrahedra of 10. Make the mesh quadratic.",
                        mesh.tetrahedra.cols()));
    }
    const auto rule = quadrature_2();
    std::vector<ElementShape> shapes(mesh.tetrahedra.rows());
    for (std::size_t e = 0; e < shapes.size(); ++e) {
        const auto X = node_positions<element_nodes>(mesh.nodes, mesh.tetrahedra.row(static_cast<Eigen::Index>(e)));
        for (int q = 0; q < element_points; ++q) {
            const auto dN = shape_gradient<4, element_nodes>(rule[q].l);
            const Mat3 J = X.transpose() * dN;  // dX_a/dl_b
            const double det = J.determinant();
            if (!(det > 0)) {
                const Vec3 centre = X.topRows<4>().colwise().mean();
                throw InvalidInput(fmt::format(
                    "Element {} of the volume mesh, near ({:.4g}, {:.4g}, {:.4g}) mm, is flat or turned inside out; "
                    "every element needs a positive volume. Mesh the body anew, finer there.",
                    e, centre.x(), centre.y(), centre.z()));
            }
            shapes[e].w(q) = rule[q].weight / 6 * det;
            shapes[e].dN.middleRows<3>(3 * q) = (dN * J.inverse()).transpose();
        }
    }
    return shapes;
}

}  // namespace palpate::fem
