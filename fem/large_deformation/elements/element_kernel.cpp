#include "fem/large_deformation/elements/element_kernel.h"

#include <limits>
#include <type_traits>

#include "fem/large_deformation/elements/point_law.h"

namespace palpate::fem {

namespace {

/// F = I + sum_i u_i dN_i/dX
Mat3 gradient(const ElementShape& shape, const NodeVectors& u, int q) {
    Mat3 F = u.lazyProduct(shape.gradients(q).transpose());
    F.diagonal().array() += 1;
    return F;
}

/// An element without effects in its material.
struct Bare {
    static constexpr bool adds = false;
    static constexpr double s(int) { return 1; }
    static constexpr double mean_s() { return 1; }
};

/// An element whose stiffness differs from place to place.
struct Scaled : Bare {
    const ElementEffects& effects;
    explicit Scaled(const ElementEffects& all) : effects(all) {}
    double s(int q) const { return effects.s(q); }
    double mean_s() const { return effects.mean_s; }
};

/// An element whose law they add to besides.
struct Extended : Scaled {
    using Scaled::Scaled;
    static constexpr bool adds = true;
};

/// The law at an element's quadrature points, and the mean of its volume measure v.
template <MaterialLaw law>
class ElementPoints {
public:
    ElementPoints(const ElementShape& shape, const ElementModel& model, const NodeVectors& u)
        : at_{at(shape, u, 0), at(shape, u, 1), at(shape, u, 2), at(shape, u, 3)} {
        for (int q = 0; q < element_points; ++q) mean_ += shape.w(q) * at_[q].v / shape.w.sum();
        local_ = model.local_bulk();
        on_mean_ = model.K - local_;
    }

    const PointLaw<law>& operator[](int q) const { return at_[q]; }
    /// Derivative of the volume's energy density by v at a point.
    template <class Effects>
    double pressure(int q, const Effects& effects) const {
        return effects.s(q) * local_ * at_[q].v + effects.mean_s() * on_mean_ * mean_;
    }
    double mean() const { return mean_; }
    bool inside_out() const {
        return at_[0].inside_out() || at_[1].inside_out() || at_[2].inside_out() || at_[3].inside_out();
    }

private:
    static PointLaw<law> at(const ElementShape& shape, const NodeVectors& u, int q) {
        return PointLaw<law>(gradient(shape, u, q));
    }

    std::array<PointLaw<law>, element_points> at_;
    double mean_ = 0, local_, on_mean_;
};

template <MaterialLaw law, class Effects>
double force_of(const ElementShape& shape, const ElementModel& model, const Effects& effects, const NodeVectors& u,
                NodeVectors& f) {
    const ElementPoints<law> points(shape, model, u);
    if (points.inside_out()) return std::numeric_limits<double>::infinity();
    const double local = model.local_bulk();
    double energy = effects.mean_s() * (model.K - local) / 2 * shape.w.sum() * points.mean() * points.mean();
    f.setZero();
    for (int q = 0; q < element_points; ++q) {
        const double mu = effects.s(q) * model.mu;
        energy += shape.w(q) * (mu * points[q].D + effects.s(q) * local / 2 * points[q].v * points[q].v);
        const Mat3 P = shape.w(q) * (mu * points[q].dD + points.pressure(q, effects) * points[q].dv);
        f += P.lazyProduct(shape.gradients(q));
    }
    if constexpr (Effects::adds) {
        for (int q = 0; q < element_points; ++q) {
            const MaterialTerms added = effects.effects.added(law, q, gradient(shape, u, q), false);
            const double weight = shape.w(q) * effects.s(q) * model.mu;
            energy += weight * added.w;
            f += (weight * added.first).eval().lazyProduct(shape.gradients(q));
        }
    }
    return energy;
}

template <MaterialLaw law, class Effects>
void tangent_of(const ElementShape& shape, const ElementModel& model, const Effects& effects, const NodeVectors& u,
                ElementTangent& K) {
    const ElementPoints<law> points(shape, model, u);
    const double local = model.local_bulk();
    std::array<MaterialTerms, Effects::adds ? element_points : 0> added;
    if constexpr (Effects::adds) {
        for (int q = 0; q < element_points; ++q) added[q] = effects.effects.added(law, q, gradient(shape, u, q), true);
    }

    // Sum over the points of dN^T A dN, where A is the second derivative of W by F.
    for (int c = 0; c < 3; ++c) {
        for (int d = c; d < 3; ++d) {
            Eigen::Matrix<double, 3 * element_points, element_nodes, Eigen::RowMajor> A_dN;
            for (int q = 0; q < element_points; ++q) {
                const double mu = effects.s(q) * model.mu;
                Mat3 A = points[q].second(c, d, mu, points.pressure(q, effects));
                A += effects.s(q) * local * points[q].dv.row(c).transpose() * points[q].dv.row(d);
                if constexpr (Effects::adds) {
                    A += mu * added[q].second.template block<3, 3>(Eigen::Index{3} * c, Eigen::Index{3} * d);
                }
                A_dN.template middleRows<3>(3 * q) = (shape.w(q) * A).eval().lazyProduct(shape.gradients(q));
            }
            K.blocks[ElementTangent::block_of(c, d)].noalias() = shape.dN.transpose().lazyProduct(A_dN);
        }
    }
    if (model.K == local) return;

    // The mean's own derivative g = sum w dv/du over V: V lambda g g^T.
    NodeVectors g = NodeVectors::Zero();
    for (int q = 0; q < element_points; ++q) {
        g += (shape.w(q) * points[q].dv).eval().lazyProduct(shape.gradients(q));
    }
    const double factor = effects.mean_s() * (model.K - local) / shape.w.sum();
    for (int c = 0; c < 3; ++c) {
        for (int d = c; d < 3; ++d) {
            K.blocks[ElementTangent::block_of(c, d)] += (factor * g.row(c)).transpose() * g.row(d);
        }
    }
}

/// Calls work(law, effects) with what an element is made of.
template <class Work>
auto dispatch(MaterialLaw law, const ElementEffects* effects, Work&& work) {
    const auto by_effects = [&]<MaterialLaw known>(std::integral_constant<MaterialLaw, known> which) {
        if (!effects) return work(which, Bare{});
        if (effects->is_scale()) return work(which, Scaled(*effects));
        return work(which, Extended(*effects));
    };
    switch (law) {
        case MaterialLaw::linear:
            return by_effects(std::integral_constant<MaterialLaw, MaterialLaw::linear>{});
        case MaterialLaw::svk:
            return by_effects(std::integral_constant<MaterialLaw, MaterialLaw::svk>{});
        default:
            return by_effects(std::integral_constant<MaterialLaw, MaterialLaw::neo_hookean>{});
    }
}

}  // namespace

ElementModel::ElementModel(const BodySetting& setting, Dilatation kept) : law(setting.law), dilatation(kept) {
    take(setting.material);
}

void ElementModel::take(const Material& material) {
    mu = material.shear_modulus();
    K = material.bulk_modulus();
    K_over_mu = K / mu;
}

double element_force(const ElementShape& shape, const ElementModel& model, const ElementEffects* effects,
                     const NodeVectors& u, NodeVectors& f) {
    return dispatch(model.law, effects,
                    [&](auto law, const auto& of) { return force_of<law()>(shape, model, of, u, f); });
}

void element_tangent(const ElementShape& shape, const ElementModel& model, const ElementEffects* effects,
                     const NodeVectors& u, ElementTangent& K) {
    dispatch(model.law, effects, [&](auto law, const auto& of) { tangent_of<law()>(shape, model, of, u, K); });
}

}  // namespace palpate::fem
