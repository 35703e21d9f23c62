// The stiffest and the softest mode of a body, for steps and damping: not part of any step.

#include <Eigen/LU>
#include <cmath>

#include "skeleton/runtime/solver/solver.h"

namespace palpate::runtime {

namespace {

// The power method closes in by the ratio of the two largest eigenvalues each time, and what it lacks then is in the
// twentieth that stable_step() keeps back. The softest mode sets damping alone: a few digits do.
constexpr int power_iterations = 200, inverse_iterations = 60;

// A start that no mode is square to but by chance.
Eigen::VectorXd any_vector(Eigen::Index size) {
    Eigen::VectorXd v(size);
    for (Eigen::Index i = 0; i < size; ++i) v[i] = std::sin(1.0 + static_cast<double>(i));
    return v;
}

}  // namespace

Solver::Vector Solver::curvature_times(const std::vector<ForceField::Block>& K, const Vector& v) const {
    Vector sum = Vector::Zero(v.size());
    for (std::size_t p = 0; p < K.size(); ++p) {
        const auto [a, b] = field_.pairs()[p];
        const Eigen::Index i = 6L * block_of_[a], j = 6L * block_of_[b];
        if (i < 0 || j < 0) continue;
        sum.segment<6>(i) += K[p] * v.segment<6>(j);
        if (a != b) sum.segment<6>(j) += K[p].transpose() * v.segment<6>(i);
    }
    return sum;
}

Solver::Vector Solver::mass_times(const double* pose, const Vector& v, bool inverse) const {
    Vector product = v;
    for (std::size_t f = 0; f < free_.size(); ++f) {
        const int i = free_[f];
        const skeleton::Sphere& sphere = field_.model().spheres[i];
        const Mat3 R = orientation_of(pose, i).toRotationMatrix(), inertia = R * sphere.inertia * R.transpose();
        auto own = product.segment<6>(static_cast<Eigen::Index>(6 * f));
        own.head<3>() *= inverse ? 1 / sphere.mass : sphere.mass;
        own.tail<3>() = inverse ? Vec3(inertia.inverse() * own.tail<3>()) : Vec3(inertia * own.tail<3>());
    }
    return product;
}

double Solver::stiffest_mode(const double* pose) {
    const std::vector<ForceField::Block> K = field_.curvature(pose);
    Vector v = any_vector(net_.size());
    double square = 0;
    for (int iteration = 0; iteration < power_iterations; ++iteration) {
        v.normalize();
        v = mass_times(pose, curvature_times(K, v), true);
        square = v.norm();
    }
    return std::sqrt(square);
}

double Solver::softest_mode(const double* pose) {
    assemble(1, pose);
    factored_ = false;
    forget_contacts();
    if (net_.size() == 0 || matrix_.factor(0, metric_)) return 0;
    Vector v = any_vector(net_.size());
    double inverse_square = 0;
    for (int iteration = 0; iteration < inverse_iterations; ++iteration) {
        v.normalize();
        v = mass_times(pose, v, false);
        matrix_.solve(v.data());
        inverse_square = v.norm();
    }
    return 1 / std::sqrt(inverse_square);
}

}  // namespace palpate::runtime
