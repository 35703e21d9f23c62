#include "identify/inference/problem/parameters.h"

#include <gtest/gtest.h>

#include "mesh/errors.h"
#include "tests/identify/lattice.h"

namespace palpate::identify {
namespace {

TEST(Parameters, ScopesNameAndShareAsTheFilesSay) {
    const skeleton::Model model = make_lattice({4, 2, 1}, 3);
    const Parameters uniform = group_stiffness(model, Scope::uniform);
    ASSERT_EQ(uniform.size(), 3);
    EXPECT_EQ(uniform.list[0].name, "elongation");
    EXPECT_EQ(uniform.list[2].name, "torsion");
    EXPECT_EQ(uniform.list[0].link, -1);

    const Parameters zones = group_stiffness(model, Scope::zones);
    ASSERT_EQ(zones.size(), 9);
    EXPECT_EQ(zones.list[7].name, "flexion:zone2");

    const Parameters links = group_stiffness(model, Scope::links);
    ASSERT_EQ(links.size(), 3 * static_cast<int>(model.links.size()));
    EXPECT_EQ(links.list[3 * 4 + 2].name, "torsion:link4");
    EXPECT_EQ(links.list[3 * 4 + 2].link, 4);
}

TEST(Parameters, StiffnessIsTheModelsTimesTheSharedMultiplier) {
    const skeleton::Model model = make_lattice({4, 2, 1}, 3);
    const Parameters zones = group_stiffness(model, Scope::zones);
    const Eigen::VectorXd theta = Eigen::VectorXd::LinSpaced(9, -1, 1);
    const Eigen::VectorXd k = zones.stiffness(theta);
    for (int l = 0; l < static_cast<int>(model.links.size()); ++l) {
        for (int s = 0; s < 3; ++s) {
            EXPECT_DOUBLE_EQ(k[3 * l + s], model.links[l].stiffness[s] * std::exp(theta[3 * model.links[l].zone + s]));
        }
    }
}

TEST(Parameters, DerivativeMatchesFiniteDifferences) {
    const Parameters zones = group_stiffness(make_lattice({4, 2, 1}, 3), Scope::zones);
    const Eigen::VectorXd theta = Eigen::VectorXd::LinSpaced(9, -1, 1);
    const Eigen::MatrixXd D = zones.derivative(zones.stiffness(theta));
    constexpr double h = 1e-6;
    for (int p = 0; p < 9; ++p) {
        const Eigen::VectorXd step = h * Eigen::VectorXd::Unit(9, p);
        const Eigen::VectorXd numeric = (zones.stiffness(theta + step) - zones.stiffness(theta - step)) / (2 * h);
        EXPECT_LT((D.col(p) - numeric).norm(), 1e-7 * numeric.norm());  // step squared and rounding over the step
    }
}

TEST(Parameters, FixedAndZeroStiffnessesStay) {
    skeleton::Model model = make_lattice({3, 1, 1});
    model.links[1].stiffness[1] = 0;
    const Parameters links = group_stiffness(model, Scope::links, {skeleton::Stiffness::torsion});
    ASSERT_EQ(links.size(), 3);
    EXPECT_EQ(links.list[2].name, "elongation:link1");
    const Eigen::VectorXd k = links.stiffness(Eigen::VectorXd::Ones(3));
    EXPECT_EQ(k[2], 500);
    EXPECT_EQ(k[4], 0);
}

TEST(Parameters, ASharedParameterStandsForTheGeometricMean) {
    skeleton::Model model = make_lattice({3, 1, 1});
    model.links[0].stiffness[0] = 1;
    model.links[1].stiffness[0] = 4;
    EXPECT_DOUBLE_EQ(group_stiffness(model, Scope::uniform).units()[0], 2);
}

TEST(Parameters, NothingToIdentifyIsToldToTheUser) {
    skeleton::Model model = make_lattice({3, 1, 1});
    for (skeleton::Link& link : model.links) link.stiffness.setZero();
    try {
        group_stiffness(model, Scope::links);
        FAIL() << "no exception";
    } catch (const InvalidInput& error) {
        EXPECT_NE(std::string(error.what()).find("give the links start values above zero"), std::string::npos);
    }
}

}  // namespace
}  // namespace palpate::identify
