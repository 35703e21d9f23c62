#include "fem/elements/element_gradients.h"

#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <Eigen/LU>
#include <span>

#include "fem/elements/shape.h"
#include "mesh/errors.h"

namespace palpate::fem {

namespace {

template <int nodes>
using NodeMatrix = Eigen::Matrix<double, nodes, 3>;

/// Midside nodes lie in the middle of their edges, to rounding.
template <int nodes>
bool is_straight(const NodeMatrix<nodes>& X) {
    for (int k = 4; k < nodes; ++k) {
        const auto [a, b] = edge_corners[k - 4];
        const double bow = (X.row(k) - (X.row(a) + X.row(b)) / 2).squaredNorm();
        if (bow > 1e-20 * (X.row(a) - X.row(b)).squaredNorm()) return false;
    }
    return true;
}

/// A quadrature rule with the shape functions' gradients at its points.
template <int nodes>
struct Rule {
    std::vector<double> weights;
    std::vector<NodeMatrix<nodes>> dN;

    explicit Rule(std::span<const QuadraturePoint> points) {
        for (const auto& point : points) {
            weights.push_back(point.weight / 6);  // the reference tetrahedron's volume
            dN.push_back(shape_gradient<4, nodes>(point.l));
        }
    }
};

template <int nodes>
void add_element(const NodeMatrix<nodes>& X, const Rule<nodes>& rule, int element, double* rows, double* mean) {
    using Row = Eigen::Map<Eigen::Matrix<double, nodes, 3, Eigen::RowMajor>>;
    Row sum(mean);
    sum.setZero();
    double volume = 0;
    for (std::size_t q = 0; q < rule.weights.size(); ++q) {
        const Mat3 J = X.transpose() * rule.dN[q];  // dx_a/dl_b
        const double det = J.determinant();
        if (!(det > 0)) {
            const Vec3 centre = X.template topRows<4>().colwise().mean();
            throw InvalidInput(
                fmt::format("Element {} of the volume mesh, near ({:.4g}, {:.4g}, {:.4g}) mm, is flat or turned inside "
                            "out; every element needs a positive volume. Mesh the body anew, finer there.",
                            element, centre.x(), centre.y(), centre.z()));
        }
        const double weight = rule.weights[q] * det;
        const NodeMatrix<nodes> g = rule.dN[q] * J.inverse();
        Row(rows + q * 3 * nodes) = std::sqrt(weight) * g;
        sum += weight * g;
        volume += weight;
    }
    sum /= std::sqrt(volume);
}

template <int nodes>
ElementGradients gradients_of(const mesh::VolumeMesh& mesh) {
    const std::array centre{QuadraturePoint{Eigen::Vector4d::Constant(0.25), 1.0}};
    const auto rule_2 = quadrature_2();
    const auto rule_5 = quadrature_5();
    const Rule<nodes> straight(nodes == 4 ? std::span<const QuadraturePoint>(centre) : rule_2), curved(rule_5);

    const auto m = static_cast<int>(mesh.tetrahedra.rows());
    ElementGradients result;
    result.first_row.assign(m + 1, 0);
    for (int e = 0; e < m; ++e) {
        const bool simple = is_straight<nodes>(node_positions<nodes>(mesh.nodes, mesh.tetrahedra.row(e)));
        result.first_row[e + 1] = result.first_row[e] + (simple ? straight : curved).weights.size();
    }
    result.rows.resize(result.first_row[m] * 3 * nodes);
    result.means.resize(static_cast<std::size_t>(m) * 3 * nodes);

    tbb::parallel_for(tbb::blocked_range<int>(0, m, 256), [&](const tbb::blocked_range<int>& range) {
        for (int e = range.begin(); e != range.end(); ++e) {
            const NodeMatrix<nodes> X = node_positions<nodes>(mesh.nodes, mesh.tetrahedra.row(e));
            const bool simple = result.first_row[e + 1] - result.first_row[e] == straight.weights.size();
            add_element<nodes>(X, simple ? straight : curved, e, &result.rows[result.first_row[e] * 3 * nodes],
                               &result.means[static_cast<std::size_t>(e) * 3 * nodes]);
        }
    });
    return result;
}

}  // namespace

ElementGradients element_gradients(const mesh::VolumeMesh& mesh) {
    return mesh.is_quadratic() ? gradients_of<10>(mesh) : gradients_of<4>(mesh);
}

}  // namespace palpate::fem
