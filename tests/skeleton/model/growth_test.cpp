// A skeleton whose material has grown evenly since its rest shape was taken.

#include "skeleton/model/growth.h"

#include <gtest/gtest.h>

#include "skeleton/links/placed/grown_links.h"
#include "skeleton/links/placed/placed_links.h"
#include "skeleton/statics/equilibrium.h"
#include "skeleton/statics/statics.h"
#include "tests/skeleton/test_effects.h"
#include "tests/skeleton/test_models.h"

namespace palpate::skeleton {
namespace {

using testing::lattice_with_skin;
using testing::make_chain;
using testing::make_full_lattice;
using testing::with_effects;
using testing::with_law;

constexpr double growth = 0.03;
const fem::Growth even{.everywhere = growth};

/// One sphere is held, so that nothing hinders its growth about that sphere's centre.
Model held_at_one(Model model) {
    for (std::size_t i = 1; i < model.spheres.size(); ++i) model.spheres[i].held = false;
    model.spheres.front().held = true;
    return model;
}

TEST(Growth, PartsSpheresAndSkinEvenly) {
    for (const EquilibriumLaw law : {EquilibriumLaw::linear, EquilibriumLaw::large_rotation}) {
        const Model model =
            with_effects(with_law(held_at_one(lattice_with_skin()), law), {{"swelling", {{"growth", growth, ""}}}});
        const Equilibrium found = equilibrium(model, {});
        const Vec3 centre = model.spheres.front().center;
        for (std::size_t i = 0; i < model.spheres.size(); ++i) {
            const Vec3 expected = centre + (1 + growth) * (model.spheres[i].center - centre);
            EXPECT_LT((found.state.x.row(static_cast<Eigen::Index>(i)).transpose() - expected).norm(), 1e-8) << i;
        }
        const Points skin = observe(model, found, model.skin);
        for (Eigen::Index v = 0; v < skin.rows(); ++v) {
            const Vec3 expected = centre + (1 + growth) * (model.skin[v].rest - centre);
            EXPECT_LT((skin.row(v).transpose() - expected).norm(), 1e-8) << v;
        }
    }
}

TEST(Growth, BeginsWhereNothingIsStrained) {
    const Model model = held_at_one(lattice_with_skin());
    const State start = grown_start(model, even);
    const Vec3 centre = model.spheres.front().center;
    EXPECT_EQ(Vec3(start.x.row(0)), centre);
    const std::vector<Link> links = grown_links(model, even);
    for (std::size_t l = 0; l < links.size(); ++l) {
        EXPECT_DOUBLE_EQ(links[l].length, (1 + growth) * model.links[l].length);
        EXPECT_NEAR((start.x.row(links[l].b) - start.x.row(links[l].a)).norm(), links[l].length, 1e-12);
    }
    EXPECT_EQ(grown_start(model, {}).x, rest_state(model).x);
}

TEST(Growth, OfAPartMakesItsLinksLonger) {
    const fem::Growth part{.parts = {{{Vec3(25, 0, 0), 8}, 0.2}}};
    for (const EquilibriumLaw law : {EquilibriumLaw::linear, EquilibriumLaw::large_rotation}) {
        const EffectRecord effect{
            "local-swelling", {{"cx", 25, ""}, {"cy", 0, ""}, {"cz", 0, ""}, {"radius", 8, ""}, {"growth", 0.2, ""}}};
        const Model model = with_effects(with_law(make_chain(6), law), {effect});
        const Equilibrium found = equilibrium(model, {});
        double x = model.spheres.front().center.x();
        for (std::size_t l = 0; l < model.links.size(); ++l) {
            const Vec3 a = model.spheres[model.links[l].a].center, b = model.spheres[model.links[l].b].center;
            x += model.links[l].length * (1 + part.between(a, b));
            EXPECT_NEAR(found.state.x(model.links[l].b, 0), x, 1e-8) << l;
        }
        EXPECT_GT(x, model.spheres.back().center.x() + 1);
    }
}

TEST(Growth, OfAPartThatIsHeldFastIsNoReasonToGiveWay) {
    // Between two spheres that stay, links that would be longer are pressed: at rest the chain is about to buckle.
    Model model = make_chain(6);
    model.spheres.back().held = true;
    fem::Effects effects;
    effects.growth.parts.push_back({{Vec3(30, 0, 0), 100}, 0.3});
    const Eigen::VectorXd k = stiffness_vector(model);
    const Eigen::MatrixXd along = Eigen::VectorXd::Unit(model.dofs(), 6 * 3);
    const Eigen::MatrixXd plain = StaticsSolver(model).linear_steps(k, along);
    const Eigen::MatrixXd grown = StaticsSolver(model, effects).linear_steps(k, along);
    EXPECT_NEAR(grown(18, 0), plain(18, 0), 1e-9 * plain(18, 0));  // elongation alone, at the same stiffness
}

TEST(Growth, OfAPartIsSteppedAsALoadIs) {
    // Stiff along and soft across: from rest with all of the growth Newton's method does not come to an end.
    Model model = make_full_lattice({4, 3, 3}, 2);
    for (Link& link : model.links) link.stiffness[0] *= 100;
    fem::Effects effects;
    effects.growth.parts.push_back({{model.spheres[18].center, 5}, 2});
    StaticsSolver solver(model, effects);
    const Equilibrium found = solver.solve(stiffness_vector(model), {}, {});
    EXPECT_LT(found.residual, 1e-6 * model.links[0].stiffness[0]);
    EXPECT_GT((found.state.x - rest_state(model).x).norm(), 1);
}

TEST(Growth, OfNothingLeavesPointsAsTheyHang) {
    const Model model = lattice_with_skin();
    const State rest = rest_state(model);
    for (const Attachment& point : model.skin) EXPECT_EQ(grown(point, rest, {}).rest, point.rest);
}

}  // namespace
}  // namespace palpate::skeleton
