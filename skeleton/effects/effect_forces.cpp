#include <Eigen/Geometry>

#include "skeleton/effects/carried_point.h"
#include "skeleton/effects/point_sets.h"
#include "skeleton/equilibrium.h"

namespace palpate::skeleton {

namespace {

// Takes a point's force to a sphere that carries it: it pulls, and turns by its arm.
Eigen::Matrix<double, 6, 3> on_sphere(const CarriedShare& share) {
    Eigen::Matrix<double, 6, 3> pull;
    pull << share.w * Mat3::Identity(), share.w * skew(share.r);
    return pull;
}

// Signatures B of the gradients at points (3 x P), gathered on the spheres (6N x P).
class Signatures {
public:
    explicit Signatures(Eigen::Index dofs) : dofs_(dofs) {}

    template <typename Force>  // 6 x P
    void subtract(int sphere, const Force& force) {
        if (sum_.cols() == 0) sum_ = Eigen::MatrixXd::Zero(dofs_, force.cols());
        sum_.middleRows<6>(Eigen::Index{6} * sphere) -= force;
    }
    const Eigen::MatrixXd& sum() const { return sum_; }

private:
    Eigen::Index dofs_;
    Eigen::MatrixXd sum_;
};

// d (gradient at rest + Hessian at rest * step) / d parameters, on a sphere that carries the point. B: how the gradient
// depends on the parameters at rest; dB: what it changes by on the point's way u, to first order.
Eigen::Matrix<double, 6, Eigen::Dynamic> linearised(const CarriedShare& share, const Eigen::Matrix3Xd& B,
                                                    const Eigen::Matrix3Xd& dB, const Vec3& turn) {
    Eigen::Matrix<double, 6, Eigen::Dynamic> force = on_sphere(share) * (B + dB);
    for (Eigen::Index p = 0; p < B.cols(); ++p)
        force.col(p).tail<3>() += share.w * turning_curvature(B.col(p), share.r) * turn;
    return force;
}

Eigen::MatrixXd linear_forces(const Model& model, const Eigen::VectorXd& step, const fem::PointPotential& effect) {
    const State rest = rest_state(model);
    const PointSet set = point_set(model, effect.acts_on());
    Signatures signatures(model.dofs());
    for (size_t i = 0; i < set.at.size(); ++i) {
        const CarriedPoint point = carried(set.at[i], rest, rest);
        Vec3 u = Vec3::Zero();
        for (int s = 0; s < point.shares; ++s) {
            const auto& [sphere, w, r] = point.of[s];
            u += w *
                 (step.segment<3>(Eigen::Index{6} * sphere) + step.segment<3>(Eigen::Index{6} * sphere + 3).cross(r));
        }
        // A difference over a small part of the way: exact for springs, and well above the rounding of positions.
        constexpr double part = 1.0 / 64;
        const Vec3& X = set.at[i].rest;
        const auto signature = [&](const Vec3& x) { return effect.terms(X, x, true).by_parameter; };
        const Eigen::Matrix3Xd B = signature(X);
        const Eigen::Matrix3Xd dB = (signature(X + part * u) - signature(X - part * u)) / (2 * part);
        for (int s = 0; s < point.shares; ++s) {
            const int sphere = point.of[s].sphere;
            const Vec3 turn = step.segment<3>(Eigen::Index{6} * sphere + 3);
            signatures.subtract(sphere, set.weights[i] * linearised(point.of[s], B, dB, turn));
        }
    }
    return signatures.sum();
}

}  // namespace

Eigen::MatrixXd effect_forces(const Model& model, const Equilibrium& equilibrium, const fem::PointPotential& effect) {
    if (model.law == Law::linear) return linear_forces(model, equilibrium.step, effect);

    const State rest = rest_state(model);
    const PointSet set = point_set(model, effect.acts_on());
    Signatures signatures(model.dofs());
    for (size_t i = 0; i < set.at.size(); ++i) {
        const CarriedPoint point = carried(set.at[i], rest, equilibrium.state);
        const Eigen::Matrix3Xd B = effect.terms(set.at[i].rest, point.x, true).by_parameter;
        for (int s = 0; s < point.shares; ++s)
            signatures.subtract(point.of[s].sphere, set.weights[i] * on_sphere(point.of[s]) * B);
    }
    return signatures.sum();
}

}  // namespace palpate::skeleton
