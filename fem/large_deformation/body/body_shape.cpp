#include "fem/large_deformation/body/body_shape.h"

#include "fem/elements/shape.h"

namespace palpate::fem {

const Skin& BodyShape::skin() const {
    return lazy_skin->get([&] { return Skin(mesh); });
}

const BodyPoints& BodyShape::boundary_points() const {
    return lazy_boundary->get([&] { return fem::boundary_points(mesh); });
}

const BodyPoints& BodyShape::node_points() const {
    return lazy_nodes->get([&] { return fem::node_points(mesh); });
}

Eigen::VectorXd BodyShape::pressures(const Effects& effects) const {
    Eigen::VectorXd result = Eigen::VectorXd::Constant(cavities.count(), effects.pressure);
    for (const CavityPressure& own : effects.cavities) {
        result[cavities.find(*own.actuator)] += own.pressure;
    }
    return result;
}

NodeWeights BodyShape::points(ActsOn what, double density) const {
    const Eigen::VectorXd& all = what == ActsOn::material  ? integrals.mass
                                 : what == ActsOn::surface ? integrals.area
                                                           : integrals.support;
    const double factor = what == ActsOn::material ? density : 1;
    NodeWeights result;
    if (factor == 0) return result;
    for (Eigen::Index i = 0; i < all.size(); ++i) {
        if (all(i) != 0) result.nodes.push_back(static_cast<int>(i));
    }
    result.weights = factor * all(result.nodes);
    return result;
}

PointPositions BodyShape::quadrature_points(std::size_t element) const {
    const auto X = node_positions<element_nodes>(mesh.nodes, mesh.tetrahedra.row(static_cast<Eigen::Index>(element)));
    const auto rule = quadrature_2();
    PointPositions points;
    for (int q = 0; q < element_points; ++q) points.row(q) = shape<4, element_nodes>(rule[q].l).transpose() * X;
    return points;
}

NodeVectors BodyShape::displacements(const Eigen::VectorXd& u, std::size_t element) const {
    const int* node = mesh.tetrahedra.data() + element * element_nodes;
    NodeVectors result;
    for (int i = 0; i < element_nodes; ++i) result.col(i) = u.segment<3>(std::int64_t(3) * node[i]);
    return result;
}

void BodyShape::add(const NodeVectors& f, std::size_t element, Eigen::Ref<Eigen::VectorXd> forces) const {
    const int* node = mesh.tetrahedra.data() + element * element_nodes;
    for (int i = 0; i < element_nodes; ++i) forces.segment<3>(std::int64_t(3) * node[i]) += f.col(i);
}

}  // namespace palpate::fem
