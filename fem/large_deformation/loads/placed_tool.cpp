#include "fem/large_deformation/loads/placed_tool.h"

#include <cmath>
#include <limits>

namespace palpate::fem {

PlacedTool::PlacedTool(const BodyShape& body, std::shared_ptr<const ToolPotential> potential)
    : body_(body),
      potential_(std::move(potential)),
      points_(potential_->acts_on() == ActsOn::material ? body.node_points() : body.boundary_points()) {
    const Eigen::VectorXd weights = potential_->weights(points_.rest, points_.weights);
    for (Eigen::Index k = 0; k < weights.size(); ++k) {
        if (weights[k] == 0) continue;
        chosen_.push_back(static_cast<int>(k));
        weights_.push_back(weights[k]);
    }
}

template <class Visit>
void PlacedTool::for_each_point(const Eigen::VectorXd& u, const Visit& visit) const {
    for (std::size_t i = 0; i < chosen_.size(); ++i) {
        const int k = chosen_[i];
        const Vec3 X = points_.rest.row(k), x = X + points_.displacement(body_.mesh, k, u);
        PointTerms terms = potential_->terms(X, x);
        if (terms.hessian.isZero(0)) continue;  // not in touch
        terms.energy *= weights_[i];
        terms.gradient *= weights_[i];
        terms.hessian *= weights_[i];
        visit(k, x, terms);
    }
}

double PlacedTool::add_gradient(const Eigen::VectorXd& u, double factor, Eigen::VectorXd& sum) const {
    double energy = 0;
    for_each_point(u, [&](int k, const Vec3&, const PointTerms& terms) {
        energy += terms.energy;
        const Carrier& at = points_.carriers[k];
        body_.add(factor * terms.gradient * at.N.transpose(), at.element, sum);
    });
    return energy;
}

void PlacedTool::add_hessian(const Eigen::VectorXd& u, const Unknowns& unknowns, LowerMatrix& K) const {
    // Points of one element come one after the other.
    ElementTangent tangent;
    int element = -1;
    const auto begin = [&](int e) {
        if (element >= 0) unknowns.add(element, tangent, K);
        for (auto& block : tangent.blocks) block.setZero();
        element = e;
    };
    for_each_point(u, [&](int k, const Vec3&, const PointTerms& terms) {
        const Carrier& at = points_.carriers[k];
        if (at.element != element) begin(at.element);
        add_outer(terms.hessian, at, tangent);
    });
    begin(-1);
}

int PlacedTool::add_near_points(const Eigen::VectorXd& u, int first, std::vector<NearPoint>& points) const {
    const double reach = potential_->reach();
    for (std::size_t i = 0; i < chosen_.size(); ++i) {
        const int k = chosen_[i];
        const Vec3 X = points_.rest.row(k), x = X + points_.displacement(body_.mesh, k, u);
        const Gap gap = potential_->gap(X, x);
        if (gap.value < reach)
            points.push_back({first + static_cast<int>(i), gap.value, gap.normal, weights_[i], &points_.carriers[k]});
    }
    return first + static_cast<int>(chosen_.size());
}

double PlacedTool::rounding() const {
    double squares = 0;
    for (const double weight : weights_) squares += weight * weight;
    const double farthest = points_.rest.cwiseAbs().maxCoeff() + potential_->origin().cwiseAbs().maxCoeff();
    return std::numeric_limits<double>::epsilon() * farthest * std::sqrt(squares);
}

Wrench PlacedTool::wrench(const Eigen::VectorXd& u) const {
    Wrench sum = Wrench::Zero();
    for_each_point(u, [&](int, const Vec3& x, const PointTerms& terms) {
        sum += PointOnTool(terms, x - potential_->origin()).wrench;
    });
    return sum;
}

Eigen::MatrixXd PlacedTool::by_pose(const Eigen::VectorXd& u) const {
    Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(u.size(), 6);
    for_each_point(u, [&](int k, const Vec3& x, const PointTerms& terms) {
        const PointOnTool part(terms, x - potential_->origin());
        const Carrier& at = points_.carriers[k];
        const int* node = body_.mesh.tetrahedra.data() + static_cast<std::size_t>(at.element) * element_nodes;
        for (int i = 0; i < element_nodes; ++i) {
            if (at.N[i] != 0) sum.middleRows<3>(std::int64_t(3) * node[i]) += at.N[i] * part.by_pose;
        }
    });
    return sum;
}

Eigen::Matrix<double, 6, 6> PlacedTool::wrench_by_pose(const Eigen::VectorXd& u) const {
    Eigen::Matrix<double, 6, 6> sum = Eigen::Matrix<double, 6, 6>::Zero();
    for_each_point(u, [&](int, const Vec3& x, const PointTerms& terms) {
        sum += PointOnTool(terms, x - potential_->origin()).wrench_by_pose;
    });
    return sum;
}

}  // namespace palpate::fem
