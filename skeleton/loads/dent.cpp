#include "skeleton/loads/dent.h"

#include <array>
#include <cmath>

namespace palpate::skeleton {

namespace {

constexpr std::array<double, 3> reaches{1, 2, 4};  // R

double kernel(double distance, double radius, double reach) {
    constexpr double blunt = 0.3;  // of the radius: part of the law (dent.h) that models' amplitudes were found with
    const double x = distance / (reach * radius);
    if (x >= 1) return 0;
    return (1 - x) * (1 - x) * (1 + 2 * x) / std::hypot(distance, blunt * radius);
}

}  // namespace

Eigen::MatrixXd dent_motions(const Load& load, const Points& rest) {
    Eigen::MatrixXd motions = Eigen::MatrixXd::Zero(3 * rest.rows(), 2 * reaches.size());
    for (const PatchForce& press : load.patch_forces) {
        const Vec3 along = press.force.dot(press.normal) * press.normal, across = press.force - along;
        const double furthest = (reaches.back() + 2) * press.radius;
        for (Eigen::Index i = 0; i < rest.rows(); ++i) {
            const Vec3 x = rest.row(i);
            if ((x - press.patch.front().first).norm() > furthest) continue;
            for (std::size_t R = 0; R < reaches.size(); ++R) {
                double mean = 0;
                for (const auto& [at, share] : press.patch)
                    mean += share * kernel((x - at).norm(), press.radius, reaches[R]);
                motions.block<3, 1>(3 * i, 2 * static_cast<Eigen::Index>(R)) += mean * along;
                motions.block<3, 1>(3 * i, 2 * static_cast<Eigen::Index>(R) + 1) += mean * across;
            }
        }
    }
    return motions;
}

Points dents(const Model& model, const Load& load, const Points& rest) {
    if (model.dent.isZero(0) || load.patch_forces.empty()) return Points::Zero(rest.rows(), 3);
    const Eigen::VectorXd moved = dent_motions(load, rest) * model.dent;
    return moved.reshaped<Eigen::RowMajor>(rest.rows(), 3);
}

}  // namespace palpate::skeleton
