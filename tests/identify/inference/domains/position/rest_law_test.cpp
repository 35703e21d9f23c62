#include "identify/inference/domains/position/rest_law.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "identify/numerics/random.h"
#include "mesh/errors.h"
#include "skeleton/statics/equilibrium.h"
#include "tests/identify/lattice.h"
#include "tests/skeleton/test_models.h"

namespace palpate::identify {
namespace {

using skeleton::EquilibriumLaw;

Eigen::MatrixXd random_matrix(Eigen::Index rows, int columns) {
    Eigen::MatrixXd M(rows, columns);
    for (int c = 0; c < columns; ++c) M.col(c) = RandomStream(7, 0, c).normals(static_cast<int>(rows));
    return M;
}

struct Body {
    const char* what;
    skeleton::Model (*make)();
};

skeleton::Model of_the_paper() { return make_lattice({4, 3, 2}); }
skeleton::Model on_a_soft_support() {
    skeleton::Model model = make_lattice({3, 3, 1});
    model.effects = {{"compliant-support", {{"stiffness", 6, "N/mm"}}}};
    return model;
}
skeleton::Model full() { return skeleton::testing::make_full_lattice({3, 3, 2}); }

class RestLawOf : public testing::TestWithParam<Body> {};

TEST_P(RestLawOf, StepsAreThoseOfTheStatics) {
    const skeleton::Model model = with_law(GetParam().make(), EquilibriumLaw::linear);
    Eigen::VectorXd k = stiffness_vector(model);
    k.array() *= (0.5 * RandomStream(8, 0, 0).normals(static_cast<int>(k.size()))).array().exp();
    const Eigen::MatrixXd F = random_matrix(model.dofs(), 5);
    const Eigen::MatrixXd expected = skeleton::StaticsSolver(model).linear_steps(k, F);
    const LinearStatics law(model);
    for (int again = 0; again < 2; ++again) {  // the second time in the memory of the first
        // rounding, by a condition of some thousands
        EXPECT_LT((law.factor(k)->solve(F) - expected).norm(), 1e-10 * expected.norm());
    }
}

TEST_P(RestLawOf, SignaturesAreTheSlopesOfForces) {
    for (const EquilibriumLaw law : {EquilibriumLaw::linear, EquilibriumLaw::large_rotation}) {
        const skeleton::Model model = with_law(GetParam().make(), law);
        const Eigen::VectorXd step = 0.1 * random_matrix(model.dofs(), 1);
        skeleton::Equilibrium at;
        at.step = step;
        at.state = skeleton::advance(rest_state(model), step);
        const Eigen::SparseMatrix<double> G = skeleton::link_forces(model, at);
        const LinkSignatures signatures(std::make_shared<LinksAtRest>(model), at, law);
        const Eigen::MatrixXd K = random_matrix(G.cols(), 3), F = random_matrix(G.rows(), 2);
        const Eigen::MatrixXd GK = G * K, GF = G.transpose() * F;
        EXPECT_LT((signatures.times(K) - GK).norm(), 1e-12 * GK.norm());  // rounding
        EXPECT_LT((signatures.transposed_times(F) - GF).norm(), 1e-12 * GF.norm());
    }
}

INSTANTIATE_TEST_SUITE_P(, RestLawOf,
                         testing::Values(Body{"lattice", of_the_paper}, Body{"supported", on_a_soft_support},
                                         Body{"full", full}),
                         [](const auto& tested) { return tested.param.what; });

TEST(LinearStatics, AFactorOutlivesItsLaw) {
    const skeleton::Model model = with_law(make_lattice({3, 2, 1}), EquilibriumLaw::linear);
    auto law = std::make_shared<const LinearStatics>(model);
    const auto factor = law->factor(stiffness_vector(model));
    law.reset();
    EXPECT_GT(factor->solve(Eigen::VectorXd::Ones(model.dofs())).norm(), 0);
}

TEST(LinearStatics, WhatIsLooseIsNamed) {
    const skeleton::Model model = with_law(make_lattice({3, 2, 1}), EquilibriumLaw::linear);
    const Eigen::VectorXd k = Eigen::VectorXd::Zero(stiffness_vector(model).size());
    const LinearStatics law(model);
    try {
        law.factor(k);
        FAIL();
    } catch (const SolverFailure& failure) {
        EXPECT_THAT(failure.what(), testing::HasSubstr("sphere"));
    }
}

}  // namespace
}  // namespace palpate::identify
