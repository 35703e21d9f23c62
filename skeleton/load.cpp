#include "skeleton/load.h"

#include <Eigen/Geometry>

namespace palpate::skeleton {

namespace {

// Calls visit(sphere, force, arm) for each share that a sphere bears of each point force.
template <typename Visit>
void for_each_share(const Model& model, const State& state, const Load& load, const Visit& visit) {
    for (const PointForce& force : load.forces) {
        const auto share = [&](int sphere, double weight) {
            if (weight != 0)
                visit(sphere, weight * force.force, state.R[sphere] * (force.at.rest - model.spheres[sphere].center));
        };
        share(force.at.a, 1 - force.at.t);
        share(force.at.b, force.at.t);
    }
}

}  // namespace

Eigen::VectorXd external_force(const Model& model, const State& state, const Load& load) {
    Eigen::VectorXd f = Eigen::VectorXd::Zero(model.dofs());
    for (size_t i = 0; i < model.spheres.size(); ++i) f.segment<3>(6 * i) = model.spheres[i].mass * load.gravity;
    for_each_share(model, state, load, [&](Eigen::Index sphere, const Vec3& force, const Vec3& arm) {
        f.segment<3>(6 * sphere) += force;
        f.segment<3>(6 * sphere + 3) += arm.cross(force);
    });
    return f;
}

double external_work(const Model& model, const State& state, const Load& load) {
    const auto displacement = [&](int sphere) -> Vec3 {
        return state.x.row(sphere).transpose() - model.spheres[sphere].center;
    };
    double work = 0;
    for (int i = 0; i < static_cast<int>(model.spheres.size()); ++i)
        work += model.spheres[i].mass * load.gravity.dot(displacement(i));
    for_each_share(model, state, load, [&](int sphere, const Vec3& force, const Vec3& arm) {
        work += force.dot(displacement(sphere) + arm - state.R[sphere].transpose() * arm);
    });
    return work;
}

std::vector<Mat3> external_curvature(const Model& model, const State& state, const Load& load) {
    // The arm r turns to r + w x r + 1/2 w x (w x r): F . r has the second derivative 1/2 (F r^T + r F^T) - (F . r) I.
    std::vector<Mat3> curvature(model.spheres.size(), Mat3::Zero());
    for_each_share(model, state, load, [&](int sphere, const Vec3& force, const Vec3& arm) {
        const Mat3 Fr = 0.5 * force * arm.transpose();
        curvature[sphere] += Fr + Fr.transpose() - force.dot(arm) * Mat3::Identity();
    });
    return curvature;
}

}  // namespace palpate::skeleton
