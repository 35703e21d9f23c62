#include "identify/inference/domains/force/force_domain.h"

#include <gtest/gtest.h>

#include "identify/inference/domains/force/node_configuration.h"
#include "identify/numerics/random.h"
#include "tests/identify/lattice.h"

namespace palpate::identify {
namespace {

std::vector<MeasuredConfiguration> twin(const skeleton::Model& truth) {
    return measured_configurations(
        truth, simulate_measurements(truth, push_spheres(truth, six_forces(0.5, 10)), markers_on_spheres(truth)));
}

double value(const ForceStatistics& s, const Eigen::VectorXd& m) { return m.dot(s.H * m) + 2 * s.g.dot(m) + s.c; }

TEST(ForceDomain, StatisticsAreTheNetForcesOfTheModel) {
    const skeleton::Model model = make_lattice({4, 2, 1}, 3);
    const auto measured = twin(with_truth(model, {1, 2, 3}, {300, 400, 500}));
    const Parameters parameters = group_stiffness(model, Scope::zones, {skeleton::Stiffness::torsion});
    const ForceDomain domain = force_domain(model, parameters, measured);

    const Eigen::VectorXd m = Eigen::VectorXd::LinSpaced(6, 0.5, 1.5);
    skeleton::Model trial = model;
    set_stiffness(trial, parameters.stiffness(m.array().log()));
    double forces = 0, torques = 0;
    for (const MeasuredConfiguration& configuration : measured) {
        const Eigen::VectorXd r = residual(trial, configuration.state, configuration.load);
        for (int i = 2; i < 8; ++i) {  // two are held
            forces += r.segment<3>(6 * i).squaredNorm();
            torques += r.segment<3>(6 * i + 3).squaredNorm() / (40 * 40);
        }
    }
    EXPECT_NEAR(value(domain.forces, m) / forces, 1, 1e-9);  // rounding
    EXPECT_NEAR(value(domain.torques, m) / torques, 1, 1e-9);
}

TEST(ForceDomain, NetForcesVanishAtTheTruthAndTheSolutionFindsIt) {
    const skeleton::Model model = make_lattice({6, 3, 1}, 3);
    const std::vector<double> kE{0.9, 2.6, 1.5}, kF{300, 850, 520};
    const Parameters parameters = group_stiffness(model, Scope::zones);
    const ForceDomain domain = force_domain(model, parameters, twin(with_truth(model, kE, kF)));
    const Eigen::VectorXd m = solve_force_domain(domain.forces + domain.torques);
    for (int zone = 0; zone < 3; ++zone) {
        // equilibria hold to 1e-9 of the load, and weak directions lose some digits
        EXPECT_NEAR(m[3 * zone], kE[zone] / 2, 1e-6);
        EXPECT_NEAR(m[3 * zone + 1], kF[zone] / 750, 1e-6);
        EXPECT_NEAR(m[3 * zone + 2], 1, 1e-5);
    }
}

TEST(ForceDomain, SolutionSatisfiesTheConditionsOfKuhnAndTucker) {
    constexpr int P = 12;
    for (int problem = 0; problem < 20; ++problem) {
        RandomStream random(1, 0, problem);
        Eigen::MatrixXd A(20, P);
        for (double& a : A.reshaped()) a = random.normal();
        const ForceStatistics statistics{(A.transpose() * A).sparseView(), A.transpose() * random.normals(20), 0};
        const Eigen::VectorXd m = solve_force_domain(statistics, 0);
        const Eigen::VectorXd gradient = statistics.H * m + statistics.g;
        for (int p = 0; p < P; ++p) {
            EXPECT_GE(m[p], 0);
            EXPECT_GE(gradient[p], -1e-9);  // rounding
            EXPECT_NEAR(m[p] * gradient[p], 0, 1e-9);
        }
    }
}

TEST(ForceDomain, OpenDirectionsStayAtTheModelsOwn) {
    const ForceStatistics statistics{Eigen::Matrix2d(Eigen::Vector2d(4, 0).asDiagonal()).sparseView(),
                                     Eigen::Vector2d(-2, 0), 1};
    const Eigen::VectorXd m = solve_force_domain(statistics);
    EXPECT_NEAR(m[0], 0.5, 1e-9);  // the prior's share is 1e-11
    EXPECT_NEAR(m[1], 1, 1e-9);
}

}  // namespace
}  // namespace palpate::identify
