#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "fem/hyperelastic_body.h"
#include "tests/fem/beam.h"
#include "tests/fem/point_potentials.h"
#include "tests/fem/rig/rigged_bar.h"

namespace palpate::fem {

/// A case of large deformation, to be solved by a factor and by iterations.
struct IteratedCase {
    const char* name;
    Beam beam;
    BodySetting setting;
    Eigen::VectorXd f;
};

inline std::vector<IteratedCase> iterated_cases() {
    std::vector<IteratedCase> cases;
    const auto add = [&](const char* name, Beam beam, BodySetting setting, const Vec3& force) {
        Eigen::VectorXd f = beam.end_force(force);
        cases.push_back({name, std::move(beam), std::move(setting), std::move(f)});
    };
    const Beam beam({8, 2, 2}, {12, 3, 3});
    add("bent under its weight", beam,
        {MaterialLaw::neo_hookean, {.density = 1e-7}, {.points = {std::make_shared<Weight>(Vec3(0, 0, -900))}}},
        {0.0005, 0.001, -0.0025});
    add("nearly incompressible", beam, {MaterialLaw::neo_hookean, {.poisson = 0.49}, {}}, {0, 0.001, -0.004});
    add("small strain", beam, {MaterialLaw::linear, {}, {}}, {0.001, 0.002, -0.002});
    add("on springs", beam, {MaterialLaw::svk, {}, {.points = {std::make_shared<Springs>(ActsOn::support, 0.05, 0.0)}}},
        {0.002, -0.001, 0.0005});
    const double young = Material{}.young;
    add("under a tool", beam,
        {MaterialLaw::neo_hookean,
         {},
         {.tools = {moved(sphere_tool(Vec3(6, 1, 4), 2), Vec3(0, 0, -1.5), Vec3::Zero(), young)}}},
        Vec3::Zero());
    // Euler's load of a bar clamped at one end, pi^2 E I / (2 L)^2, by a half more: tangents on the way are indefinite.
    const Beam slender({12, 1, 1}, {12, 1, 1});
    const double euler = std::numbers::pi * std::numbers::pi * young / 12 / (4 * 144);
    add("buckled", slender, {MaterialLaw::neo_hookean, {}, {}}, {-1.5 * euler, 0, 0.01 * euler});
    return cases;
}

/// Equilibria and tangents are those by a factor.
inline void expect_as_by_a_factor(Solver solver, const std::vector<IteratedCase>& cases) {
    const NewtonOptions sharp{.tolerance = 1e-10, .iterations = 200};
    for (const IteratedCase& one : cases) {
        const HyperelasticBody factored(one.beam.mesh, one.beam.held, Dilatation::mean, {}, Solver::factor);
        const HyperelasticBody iterated(one.beam.mesh, one.beam.held, Dilatation::mean, {}, solver);
        const Eigen::VectorXd u = factored.equilibrium(one.setting, one.f, sharp).u;
        const Eigen::VectorXd v = iterated.equilibrium(one.setting, one.f, sharp).u;
        // Newton's tolerance times the condition of a slender bar.
        EXPECT_LT(relative(v, u), 1e-6) << one.name;
        const Eigen::MatrixXd B =
            scatter(u.size(), 1).reshaped(u.size(), 1).replicate(1, 3) * Eigen::Vector3d(1, 0, 2).asDiagonal();
        const Eigen::MatrixXd X = factored.factor(u, one.setting)->solve(B);
        EXPECT_LT((iterated.factor(u, one.setting)->solve(B) - X).norm(), 1e-8 * X.norm()) << one.name;
    }
}

}  // namespace palpate::fem
