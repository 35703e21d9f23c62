#include "skeleton/statics/statics.h"

#include <gtest/gtest.h>

#include "mesh/errors.h"
#include "skeleton/model/observation.h"
#include "tests/skeleton/test_models.h"

namespace palpate::skeleton {
namespace {

using testing::at_sphere;
using testing::make_chain;
using testing::make_lattice;
using testing::random_state;
using testing::random_vector;

// Forces at spheres, on links and off them, and gravity.
Load some_load(const Model& model) {
    Load load;
    load.forces.push_back({at_sphere(model, 1), {0.1, 0.2, -0.3}});
    load.forces.push_back({between(model, 0, 1, 0.3, {3, 5, 1}), {-0.2, 0.1, 0.4}});
    load.forces.push_back({on_sphere(model, 2, {19, -6, 2}), {0.3, -0.3, 0.1}});
    load.gravity = {0, 500, -9810};
    return load;
}

class Statics : public ::testing::Test {
protected:
    std::mt19937_64 engine{7};
    const Model model = make_lattice({3, 2, 2});
    const Load load = some_load(model);
    const State state = random_state(model, engine, 2, 0.6);
};

TEST_F(Statics, ResidualIsMinusThePotentialsDerivative) {
    const Eigen::VectorXd r = residual(model, state, load);
    const double h = 1e-5;
    for (int j = 0; j < model.dofs(); ++j) {
        const Eigen::VectorXd step = h * Eigen::VectorXd::Unit(model.dofs(), j);
        const double slope =
            (potential(model, advance(state, step), load) - potential(model, advance(state, -step), load)) / (2 * h);
        // Rounding of an energy of some 1e3 over h is 1e-8; h^2 times third derivatives of 1e3 as much.
        EXPECT_NEAR(r[j], -slope, 1e-6) << j;
    }
}

TEST_F(Statics, TangentIsTheResidualsDerivative) {
    const Eigen::MatrixXd J = tangent(model, state, load);
    Eigen::MatrixXd D(model.dofs(), model.dofs());
    const double h = 1e-5;
    for (int j = 0; j < model.dofs(); ++j) {
        const Eigen::VectorXd step = h * Eigen::VectorXd::Unit(model.dofs(), j);
        D.col(j) =
            (residual(model, advance(state, -step), load) - residual(model, advance(state, step), load)) / (2 * h);
    }
    EXPECT_LT((J - J.transpose()).norm(), 1e-13 * J.norm());  // rounding
    // Differences of torques see turned frames: their symmetric part is the derivative in exponential coordinates.
    EXPECT_LT((J - 0.5 * (D + D.transpose())).norm(), 1e-8 * J.norm());
}

TEST_F(Statics, ResidualIsLinearInTheStiffness) {
    const Eigen::VectorXd k = stiffness_vector(model);
    const Eigen::VectorXd r = external_force(model, state, load) + link_forces(model, state) * k;
    EXPECT_LT((r - residual(model, state, load)).norm(), 1e-13 * link_forces(model, state).norm() * k.norm());
}

TEST_F(Statics, LinksExertNoNetForceNorTorque) {
    const Eigen::VectorXd f = link_forces(model, state) * stiffness_vector(model);
    Vec3 force = Vec3::Zero(), torque = Vec3::Zero();
    for (int i = 0; i < static_cast<int>(model.spheres.size()); ++i) {
        force += f.segment<3>(6 * i);
        torque += f.segment<3>(6 * i + 3) + Vec3(state.x.row(i)).cross(f.segment<3>(6 * i));
    }
    // Rounding of sums of forces of some 10 N on arms of 30 mm.
    EXPECT_LT(force.norm(), 1e-12);
    EXPECT_LT(torque.norm(), 1e-10);
}

TEST_F(Statics, ExternalForceDoesTheWorkOfTheForcesOnTheBody) {
    const Eigen::VectorXd f = external_force(model, state, load);
    Vec3 force = Vec3::Zero(), torque = Vec3::Zero(), applied = Vec3::Zero(), moment = Vec3::Zero();
    for (int i = 0; i < static_cast<int>(model.spheres.size()); ++i) {
        force += f.segment<3>(6 * i);
        torque += f.segment<3>(6 * i + 3) + Vec3(state.x.row(i)).cross(f.segment<3>(6 * i));
        const Vec3 weight = model.spheres[i].mass * load.gravity;
        applied += weight;
        moment += Vec3(state.x.row(i)).cross(weight);
    }
    for (const PointForce& point : load.forces) {
        applied += point.force;
        const Vec3 where = observe(model, state, {point.at}).row(0);
        moment += where.cross(point.force);
    }
    EXPECT_LT((force - applied).norm(), 1e-14);
    EXPECT_LT((torque - moment).norm(), 1e-13);
}

TEST(StiffnessVector, IsSetAsItIsRead) {
    Model model = make_chain(3);
    const Eigen::VectorXd k = Eigen::VectorXd::LinSpaced(9, 1, 9);
    set_stiffness(model, k);
    EXPECT_EQ(stiffness_vector(model), k);
    EXPECT_EQ(model.links[1].stiffness, Vec3(4, 5, 6));
}

TEST(RestDirection, NeedsTwoPlaces) {
    Model model = make_chain(2);
    model.spheres[2].center = model.spheres[1].center;
    try {
        rest_direction(model, model.links[1]);
        FAIL();
    } catch (const InvalidInput& error) {
        EXPECT_STREQ(error.what(),
                     "spheres 1 and 2 are linked but have the same centre (10, 0, 0): "
                     "move one of them or take the link away");
    }
}

}  // namespace
}  // namespace palpate::skeleton
