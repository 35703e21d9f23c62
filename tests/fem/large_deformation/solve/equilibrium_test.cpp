#include <tbb/parallel_for.h>

#include <cmath>

#include "fem/elastic_body.h"
#include "mesh/errors.h"
#include "tests/fem/beam.h"
#include "tests/fem/point_potentials.h"
#include "tests/messages.h"

namespace palpate::fem {
namespace {

using testing::AllOf;
using testing::HasSubstr;

TEST(Equilibrium, ForcesBalanceAtFreeNodes) {
    const Beam beam({8, 2, 2}, {6, 2, 2});
    const HyperelasticBody body = beam.body();
    const Eigen::VectorXd f = beam.end_force({0.0005, 0.001, -0.0025});
    for (const MaterialLaw law : laws) {
        const BodySetting setting{law, {.density = 1e-7}, {.points = {std::make_shared<Weight>(Vec3(0, 0, -900))}}};
        const BodyEquilibrium found = body.equilibrium(setting, f);
        Eigen::VectorXd r = body.residual(found.u, setting, f);
        for (std::size_t i = 0; i < beam.held.size(); ++i) {
            if (beam.held[i]) r.segment<3>(3 * i).setZero();
        }
        EXPECT_NEAR(r.norm(), found.residual, 1e-15);
        // 1e-8 of the nodes' loads, whose norm is less than their sum of 0.003 N and as much weight.
        EXPECT_LT(r.norm(), 1e-8 * 0.006);
        EXPECT_GT(beam.tip(found.u).norm(), 0.5);  // far from small strain
        if (law == MaterialLaw::linear) {
            EXPECT_EQ(found.factorisations, 1);
        }
    }
}

TEST(Equilibrium, NoLoadNoDisplacement) {
    const Beam beam({4, 1, 1}, {4, 1, 1});
    const Eigen::VectorXd none = Eigen::VectorXd::Zero(beam.mesh.nodes.size());
    for (const MaterialLaw law : laws) EXPECT_EQ(beam.body().equilibrium({law, {}, {}}, none).u, none);
}

/// Energy density of a bar stretched by a along and by b across.
double stretch_energy(MaterialLaw law, const Material& material, double a, double b) {
    const double mu = material.shear_modulus(), K = material.lame_lambda() + 2 * mu / 3;
    if (law == MaterialLaw::neo_hookean) {
        const double J = a * b * b;
        return mu / 2 * (std::pow(J, -2.0 / 3) * (a * a + 2 * b * b) - 3) + K / 2 * (J - 1) * (J - 1);
    }
    const double along = (a * a - 1) / 2, across = (b * b - 1) / 2, trace = along + 2 * across;
    return mu * 2 / 3 * (along - across) * (along - across) + K / 2 * trace * trace;
}

TEST(Equilibrium, BarStretchesAsItsEnergySays) {
    // Pulled at both ends it would float away: springs a millionth as stiff hold it.
    const Beam beam({3, 1, 1}, {3, 1, 1});
    const HyperelasticBody body = beam.body();
    const Material material{.young = 0.5, .poisson = 0.4, .density = 0};
    const double a = 1.3, h = 1e-5;
    for (const MaterialLaw law : {MaterialLaw::svk, MaterialLaw::neo_hookean}) {
        const auto energy = [&](double along, double across) { return stretch_energy(law, material, along, across); };
        // Across there is no stress: bisection for the width.
        double low = 0.5, high = 1;
        for (int k = 0; k < 60; ++k) {
            const double b = (low + high) / 2;
            (energy(a, b + h) > energy(a, b - h) ? high : low) = b;
        }
        const double pull = (energy(a + h, low) - energy(a - h, low)) / (2 * h);
        const Eigen::VectorXd f = beam.traction(3, Vec3(pull, 0, 0)) + beam.traction(0, Vec3(-pull, 0, 0));
        const BodySetting setting{law, material, {.points = {std::make_shared<Springs>(ActsOn::support, 1e-7, 0.0)}}};
        // Sharply, as little force turns it.
        const BodyEquilibrium found = body.equilibrium(setting, f, {.tolerance = 1e-13});
        const Vec3 first = found.u.head<3>();  // of the corner at the origin
        const Eigen::VectorXd exact = nodal(beam.mesh, [&](const Vec3& x) {
            return Vec3(first + Vec3((a - 1) * x.x(), (low - 1) * x.y(), (low - 1) * x.z()));
        });
        EXPECT_LT((found.u - exact).norm(), 1e-6 * exact.norm()) << static_cast<int>(law);  // what the springs take
    }
}

TEST(Equilibrium, SmallLoadsBendAllLawsAlike) {
    const Beam beam({6, 2, 2}, {6, 2, 2});
    const Eigen::VectorXd f = beam.end_force({1e-9, 2e-9, -1e-8});
    const Material material{.young = 0.3, .poisson = 0.47};
    const Eigen::VectorXd linear = ElasticBody(beam.mesh, material, beam.held).solve(Eigen::MatrixXd(f));
    EXPECT_LT(relative(beam.body().equilibrium({MaterialLaw::linear, material, {}}, f).u, linear), 1e-9);  // rounding
    for (const MaterialLaw law : {MaterialLaw::svk, MaterialLaw::neo_hookean}) {
        // Strains are about 1e-7, the laws part by their squares.
        EXPECT_LT(relative(beam.body().equilibrium({law, material, {}}, f).u, linear), 1e-5);
    }
}

TEST(Equilibrium, MeanDilatationDoesNotLock) {
    const Material material{.young = 0.5, .poisson = 0.499};
    const auto deflection = [&](const Eigen::Vector3i& cells, Dilatation dilatation) {
        const Beam beam({40, 8, 8}, cells);
        const Eigen::VectorXd f = beam.end_force({0, 0, -0.1});
        return -beam.tip(beam.body(dilatation).equilibrium({MaterialLaw::neo_hookean, material, {}}, f).u).z();
    };
    const double fine = deflection({18, 4, 4}, Dilatation::mean);
    EXPECT_GT(fine, 8);                                                      // a fifth of its length
    EXPECT_NEAR(deflection({9, 2, 2}, Dilatation::mean) / fine, 1.0, 0.02);  // its corners, at the clamp
    EXPECT_LT(deflection({9, 2, 2}, Dilatation::full) / fine, 0.96);
}

TEST(Equilibrium, BodyOnSpringsMovesByForceOverStiffness) {
    const Beam beam({6, 2, 2}, {4, 2, 2});
    const HyperelasticBody body = beam.body();
    const Vec3 force(0.02, -0.01, 0.005);
    const double k = 0.05;  // [N/mm]
    for (const MaterialLaw law : laws) {
        const BodySetting setting{law, {}, {.points = {std::make_shared<Springs>(ActsOn::support, k, 0.0)}}};
        const Eigen::VectorXd u = body.equilibrium(setting, beam.end_force(force)).u;
        // In the mean over the springs, exactly; to Newton's tolerance times the condition.
        Vec3 mean = Vec3::Zero();
        const NodeWeights support = body.points(ActsOn::support, 0);
        for (std::size_t i = 0; i < support.nodes.size(); ++i) {
            mean += support.weights(static_cast<Eigen::Index>(i)) * u.segment<3>(3 * support.nodes[i]);
        }
        EXPECT_LT((mean - force / k).norm(), 1e-6 * force.norm() / k);
    }
}

TEST(Equilibrium, LinearLawTakesEffectsAsTheyAreAtRest) {
    // Springs that stiffen when stretched are as at rest, so that the answer is in proportion to the load.
    const Beam beam({6, 2, 2}, {4, 2, 2});
    const HyperelasticBody body = beam.body();
    const Eigen::VectorXd f = beam.end_force({0, 0, -0.01});
    const auto answer = [&](MaterialLaw law, double q, double share) {
        return body
            .equilibrium({law, {}, {.points = {std::make_shared<Springs>(ActsOn::surface, 0.001, q)}}}, share * f)
            .u;
    };
    const Eigen::VectorXd u = answer(MaterialLaw::linear, 0.01, 1);
    EXPECT_LT(relative(answer(MaterialLaw::linear, 0, 1), u), 1e-12);
    EXPECT_LT(relative(answer(MaterialLaw::linear, 0.01, 10), 10 * u), 1e-9);  // rounding times condition
    EXPECT_GT(relative(answer(MaterialLaw::svk, 0.01, 1), answer(MaterialLaw::svk, 0, 1)), 0.01);
}

TEST(Equilibrium, DoesNotDependOnTheStart) {
    const Beam beam({8, 2, 2}, {6, 2, 2});
    const HyperelasticBody body = beam.body();
    const BodySetting setting{MaterialLaw::neo_hookean, {}, {}};
    const Eigen::VectorXd f = beam.end_force({0.001, 0.002, -0.004});
    const NewtonOptions sharp{.tolerance = 1e-11};
    const BodyEquilibrium cold = body.equilibrium(setting, f, sharp);
    const Eigen::VectorXd near = 0.97 * cold.u;
    const Eigen::VectorXd far = body.equilibrium(setting, -0.5 * f).u;
    const Eigen::VectorXd inside_out = nodal(beam.mesh, [](const Vec3& x) { return Vec3(-2 * x.x(), 0, 0); });
    const BodyEquilibrium warm = body.equilibrium(setting, f, sharp, &near);
    EXPECT_LT(warm.factorisations, cold.factorisations);
    // Tolerance times the condition of a slender bar.
    EXPECT_LT(relative(warm.u, cold.u), 1e-7);
    EXPECT_LT(relative(body.equilibrium(setting, f, sharp, &far).u, cold.u), 1e-7);
    EXPECT_LT(relative(body.equilibrium(setting, f, sharp, &inside_out).u, cold.u), 1e-7);
}

TEST(Equilibrium, GoesByATangentFromNearbyWithoutAFactorOfItsOwn) {
    const Beam beam({8, 2, 2}, {6, 2, 2});
    const HyperelasticBody body = beam.body();
    const Eigen::VectorXd f = beam.end_force({0.0005, 0.001, -0.0025});
    for (const MaterialLaw law : laws) {
        BodySetting setting{law, {.density = 1e-7}, {.points = {std::make_shared<Weight>(Vec3(0, 0, -900))}}};
        const Eigen::VectorXd near = body.equilibrium(setting, f).u;
        const auto guide = body.factor(near, setting);
        setting.material.young *= 1.05;
        const BodyEquilibrium alone = body.equilibrium(setting, f, {}, &near);
        const BodyEquilibrium guided = body.equilibrium(setting, f, {}, &near, nullptr, guide.get());
        EXPECT_GE(alone.factorisations, 1);
        EXPECT_EQ(guided.factorisations, 0);
        EXPECT_LT((guided.u - alone.u).norm(), 1e-7 * alone.u.norm());
    }
}

TEST(Equilibrium, ABadGuideDoesNotLeadAstray) {
    const Beam beam({8, 2, 2}, {6, 2, 2});
    const HyperelasticBody body = beam.body();
    const Eigen::VectorXd f = beam.end_force({0.0005, 0.001, -0.0025}), rest = Eigen::VectorXd::Zero(f.size());
    const BodySetting setting{MaterialLaw::neo_hookean, {}, {}};
    const Eigen::VectorXd answer = body.equilibrium(setting, f).u;

    // a hundred times as stiff
    BodySetting stiff = setting;
    stiff.material.young *= 100;
    const auto slow = body.factor(rest, stiff);
    EXPECT_LT((body.equilibrium(setting, f, {}, &rest, nullptr, slow.get()).u - answer).norm(), 1e-6 * answer.norm());

    // over other unknowns: of a body whose supports give way
    BodySetting loose = setting;
    loose.effects.points = {std::make_shared<Springs>(ActsOn::support, 0.05, 0.0)};
    const auto other = body.factor(rest, loose);
    const BodyEquilibrium found = body.equilibrium(setting, f, {}, &answer, nullptr, other.get());
    EXPECT_LT((found.u - answer).norm(), 1e-6 * answer.norm());
}

TEST(Equilibrium, LargeLoadsAreAppliedInSteps) {
    const Beam beam({12, 1, 1}, {8, 1, 1});
    const HyperelasticBody body = beam.body();
    const BodySetting setting{MaterialLaw::neo_hookean, {}, {}};
    const Eigen::VectorXd f = beam.end_force({0, 0, -0.0002});
    // With so few iterations at one load it takes several loads.
    const NewtonOptions few{.tolerance = 1e-10, .iterations = 9}, many{.tolerance = 1e-10, .iterations = 200};
    const BodyEquilibrium stepped = body.equilibrium(setting, f, few), at_once = body.equilibrium(setting, f, many);
    EXPECT_GT(stepped.iterations, few.iterations);
    EXPECT_GT(at_once.iterations, few.iterations);
    EXPECT_LT(relative(stepped.u, at_once.u), 1e-6);  // tolerance times condition
    EXPECT_GT(-beam.tip(stepped.u).z(), 6);           // half its length
}

TEST(Equilibrium, UnbearableLoadsAreNamed) {
    // St. Venant-Kirchhoff's law gives way under pressures of a fifth of Young's modulus already; this is ten times it.
    const Beam beam({2, 2, 2}, {2, 2, 2});
    const Eigen::VectorXd f = beam.end_force({-4, 0, 0});
    EXPECT_THAT(message_of<SolverFailure>([&] {
                    beam.body().equilibrium({MaterialLaw::svk, {}, {}}, f, {.iterations = 15});
                }),
                AllOf(HasSubstr("No equilibrium was found under a load of"), HasSubstr("N stay unbalanced"),
                      HasSubstr("a body of E = 0.1 MPa, possibly beyond its stability limit")));
}

TEST(Equilibrium, ThreadsDoNotChangeANumber) {
    // The first to ask for the released supports analyses them, while others wait.
    const Beam beam({6, 2, 2}, {6, 2, 2});
    const BodySetting setting{
        MaterialLaw::neo_hookean, {}, {.points = {std::make_shared<Springs>(ActsOn::support, 0.05, 0.0)}}};
    const auto answers = [&](bool together) {
        const HyperelasticBody body = beam.body();
        std::vector<Eigen::VectorXd> u(8);
        const auto solve = [&](int k) { u[k] = body.equilibrium(setting, beam.end_force({0, 1e-3 * k, -0.01})).u; };
        if (together) {
            tbb::parallel_for(0, 8, solve);
        } else {
            for (int k = 0; k < 8; ++k) solve(k);
        }
        return u;
    };
    EXPECT_EQ(answers(true), answers(false));
}

}  // namespace
}  // namespace palpate::fem
