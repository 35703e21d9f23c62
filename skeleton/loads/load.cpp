#include "skeleton/loads/load.h"

#include <Eigen/Geometry>

#include "skeleton/model/attachment/carried_point.h"

namespace palpate::skeleton {

Eigen::VectorXd external_force(const Model& model, const State& state, const Load& load) {
    const State rest = rest_state(model);
    Eigen::VectorXd f = Eigen::VectorXd::Zero(model.dofs());
    for (size_t i = 0; i < model.spheres.size(); ++i) f.segment<3>(6 * i) = model.spheres[i].mass * load.gravity;
    for (const PointForce& force : load.forces) {
        const CarriedPoint point(force.at, rest, state);
        for (int i = 0; i < point.shares(); ++i)
            f.segment<6>(Eigen::Index{6} * point.sphere(i)) += point.jacobian(i).transpose() * force.force;
    }
    if (load.cavities) load.cavities->add_gradient(state, load.pressure, f);
    return f;
}

double external_work(const Model& model, const State& state, const Load& load) {
    const State rest = rest_state(model);
    double work = 0;
    for (int i = 0; i < static_cast<int>(model.spheres.size()); ++i)
        work += model.spheres[i].mass * load.gravity.dot(state.x.row(i).transpose() - model.spheres[i].center);
    for (const PointForce& force : load.forces)
        work += force.force.dot(CarriedPoint(force.at, rest, state).x() - force.at.rest);
    if (load.cavities) work += load.pressure * (load.cavities->volume(state) - load.cavities->rest_volume());
    return work;
}

std::vector<CurvatureBlock> external_curvature(const Model& model, const State& state, const Load& load) {
    const State rest = rest_state(model);
    std::vector<CurvatureBlock> blocks;
    for (const PointForce& force : load.forces) {
        const CarriedPoint point(force.at, rest, state);
        const Eigen::MatrixXd H = point.curvature(force.force);
        for (int i = 0; i < point.shares(); ++i)
            for (int j = 0; j < point.shares(); ++j)
                if (point.sphere(i) <= point.sphere(j))
                    blocks.push_back({point.sphere(i), point.sphere(j), H.block<6, 6>(6 * i, 6 * j)});
    }
    if (load.cavities)
        load.cavities->for_each_block(state, [&](int a, int b, const Cavities::Block& block) {
            blocks.push_back({a, b, load.pressure * block});
        });
    return blocks;
}

}  // namespace palpate::skeleton
