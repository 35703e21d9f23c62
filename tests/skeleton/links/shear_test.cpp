#include <gtest/gtest.h>

#include "skeleton/effects/link_effects.h"
#include "skeleton/links/placed/placed_links.h"
#include "skeleton/links/shear.h"
#include "skeleton/statics/equilibrium.h"
#include "tests/skeleton/test_effects.h"

namespace palpate::skeleton {
namespace {

using testing::force_at;
using testing::make_chain;
using testing::make_lattice;
using testing::with_law;

TEST(TorsionInLinks, IsAShareOfFlexion) {
    const Model model = make_lattice({4, 2, 2});
    const double share = 0.7;
    Eigen::VectorXd k = stiffness_vector(model);
    for (size_t l = 0; l < model.links.size(); ++l) k[3 * l + 2] += share * k[3 * l + 1];
    const Load load = force_at(model, 3, {1, 2, -3});
    for (const EquilibriumLaw law : {EquilibriumLaw::linear, EquilibriumLaw::large_rotation}) {
        const Model tested = with_law(model, law);
        const Eigen::VectorXd expected = StaticsSolver(tested).solve(k, load, {1e-12}).step;
        const Eigen::VectorXd step = StaticsSolver(tested, {.of_model = {in_links({.torsion = share})}})
                                         .solve(stiffness_vector(model), load, {1e-12})
                                         .step;
        EXPECT_LT((step - expected).norm(), 1e-9);  // forces known to 1e-12 of 4 N, over stiffnesses of 1 N/mm
    }
}

// A link of 10 mm along x.
Shear shear_of(const Vec3& x_b, const Vec3& turn_a, const Vec3& turn_b) {
    return {10, Vec3::UnitX(), Vec3::Zero(), rotation(turn_a), x_b, rotation(turn_b)};
}

TEST(ShearInLinks, CostsAnOffsetOfTheEnds) {
    // One end shifted across by 0.1 mm, neither turned: y is the shift, but for its third power.
    EXPECT_NEAR(shear_of({10, 0.1, 0}, {0, 0, 0}, {0, 0, 0}).energy(), 0.5 * 0.1 * 0.1, 1e-6);
    // One end turned by 0.02: the mean direction has turned by half of it.
    EXPECT_NEAR(shear_of({10, 0, 0}, {0, 0.02, 0}, {0, 0, 0}).energy(), 0.5 * 0.1 * 0.1, 1e-6);
}

TEST(ShearInLinks, PureBendingTwistAndTensionCostNone) {
    EXPECT_NEAR(shear_of({9, 0, 0}, {0, 0.4, 0.1}, {0, -0.4, -0.1}).energy(), 0, 1e-28);
    EXPECT_NEAR(shear_of({12, 0, 0}, {0, 0, 0}, {0.7, 0, 0}).energy(), 0, 1e-28);
}

TEST(ShearInLinks, AddsToWhatEndsThatStayParallelWithstand) {
    // A chain of one link, its free end kept from turning by great torsion and flexion of a second one would be a
    // frame; simpler: its linear stiffness across. A shift y with both ends straight costs kF (y/L)^2 + kS y^2 / 2.
    const Model link = make_chain(1);
    const double share = 0.3, L = 10;
    const Vec3 k = link.links[0].stiffness;
    const PlacedLinks links(link, {.of_model = {in_links({.shear = share})}});
    const Mat12 H = links.linear_hessian(0, k);
    EXPECT_NEAR(H(7, 7), 2 * k[1] / (L * L) + share * k[0], 1e-12);
    EXPECT_NEAR(H(8, 8), 2 * k[1] / (L * L) + share * k[0], 1e-12);
    EXPECT_NEAR(H(6, 6), k[0], 1e-12);
}

TEST(ShearInLinks, StiffensACantileverInBothLaws) {
    const Model bar = make_chain(4);
    const Load load = force_at(bar, 4, {0, 0.5, 0});
    for (const EquilibriumLaw law : {EquilibriumLaw::linear, EquilibriumLaw::large_rotation}) {
        const Model tested = with_law(bar, law);
        double last = StaticsSolver(tested).solve(stiffness_vector(bar), load).step[25];
        for (const double share : {0.5, 2.0, 8.0}) {
            const double tip = StaticsSolver(tested, {.of_model = {in_links({.shear = share})}})
                                   .solve(stiffness_vector(bar), load)
                                   .step[25];
            EXPECT_LT(tip, last);
            last = tip;
        }
    }
}

}  // namespace
}  // namespace palpate::skeleton
