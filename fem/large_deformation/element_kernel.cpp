#include "fem/large_deformation/element_kernel.h"

#include <limits>

#include "fem/large_deformation/point_law.h"

namespace palpate::fem {

namespace {

/// The law at an element's quadrature points, and the mean of its volume measure v.
template <Law law>
class Points {
public:
    Points(const ElementShape& shape, const ElementModel& model, const NodeVectors& u)
        : at_{at(shape, u, 0), at(shape, u, 1), at(shape, u, 2), at(shape, u, 3)} {
        for (int q = 0; q < element_points; ++q) mean_ += shape.w(q) * at_[q].v / shape.w.sum();
        local_ = model.local_bulk();
        on_mean_ = model.K - local_;
    }

    const PointLaw<law>& operator[](int q) const { return at_[q]; }
    /// Derivative of the volume's energy density by v at a point.
    double pressure(int q) const { return local_ * at_[q].v + on_mean_ * mean_; }
    double mean() const { return mean_; }
    bool inside_out() const {
        return at_[0].inside_out() || at_[1].inside_out() || at_[2].inside_out() || at_[3].inside_out();
    }

private:
    /// F = I + sum_i u_i dN_i/dX
    static PointLaw<law> at(const ElementShape& shape, const NodeVectors& u, int q) {
        Mat3 F = u.lazyProduct(shape.gradients(q).transpose());
        F.diagonal().array() += 1;
        return PointLaw<law>(F);
    }

    std::array<PointLaw<law>, element_points> at_;
    double mean_ = 0, local_, on_mean_;
};

template <Law law>
double force_of(const ElementShape& shape, const ElementModel& model, const NodeVectors& u, NodeVectors& f) {
    const Points<law> points(shape, model, u);
    if (points.inside_out()) return std::numeric_limits<double>::infinity();
    const double local = model.local_bulk();
    double energy = (model.K - local) / 2 * shape.w.sum() * points.mean() * points.mean();
    f.setZero();
    for (int q = 0; q < element_points; ++q) {
        energy += shape.w(q) * (model.mu * points[q].D + local / 2 * points[q].v * points[q].v);
        const Mat3 P = shape.w(q) * (model.mu * points[q].dD + points.pressure(q) * points[q].dv);
        f += P.lazyProduct(shape.gradients(q));
    }
    return energy;
}

template <Law law>
void tangent_of(const ElementShape& shape, const ElementModel& model, const NodeVectors& u, ElementTangent& K) {
    const Points<law> points(shape, model, u);
    const double local = model.local_bulk();

    // Sum over the points of dN^T A dN, where A is the second derivative of W by F.
    for (int c = 0; c < 3; ++c) {
        for (int d = c; d < 3; ++d) {
            Eigen::Matrix<double, 3 * element_points, element_nodes, Eigen::RowMajor> A_dN;
            for (int q = 0; q < element_points; ++q) {
                Mat3 A = points[q].second(c, d, model.mu, points.pressure(q));
                A += local * points[q].dv.row(c).transpose() * points[q].dv.row(d);
                A_dN.template middleRows<3>(3 * q) = (shape.w(q) * A).eval().lazyProduct(shape.gradients(q));
            }
            K.blocks[ElementTangent::block_of(c, d)].noalias() = shape.dN.transpose().lazyProduct(A_dN);
        }
    }
    if (model.dilatation == Dilatation::full) return;

    // The mean's own derivative g = sum w dv/du over V: V lambda g g^T.
    NodeVectors g = NodeVectors::Zero();
    for (int q = 0; q < element_points; ++q) {
        g += (shape.w(q) * points[q].dv).eval().lazyProduct(shape.gradients(q));
    }
    const double factor = (model.K - local) / shape.w.sum();
    for (int c = 0; c < 3; ++c) {
        for (int d = c; d < 3; ++d) {
            K.blocks[ElementTangent::block_of(c, d)] += (factor * g.row(c)).transpose() * g.row(d);
        }
    }
}

}  // namespace

ElementModel::ElementModel(const BodySetting& setting, Dilatation kept)
    : law(setting.law),
      mu(setting.material.shear_modulus()),
      K(setting.material.young / (3 * (1 - 2 * setting.material.poisson))),
      dilatation(kept) {}

double element_force(const ElementShape& shape, const ElementModel& model, const NodeVectors& u, NodeVectors& f) {
    switch (model.law) {
        case Law::linear:
            return force_of<Law::linear>(shape, model, u, f);
        case Law::svk:
            return force_of<Law::svk>(shape, model, u, f);
        default:
            return force_of<Law::neo_hooke>(shape, model, u, f);
    }
}

void element_tangent(const ElementShape& shape, const ElementModel& model, const NodeVectors& u, ElementTangent& K) {
    switch (model.law) {
        case Law::linear:
            return tangent_of<Law::linear>(shape, model, u, K);
        case Law::svk:
            return tangent_of<Law::svk>(shape, model, u, K);
        default:
            return tangent_of<Law::neo_hooke>(shape, model, u, K);
    }
}

}  // namespace palpate::fem
