// A skeleton whose material has grown evenly since its rest shape was taken.

#include "skeleton/model/growth.h"

#include <gtest/gtest.h>

#include "skeleton/statics/equilibrium.h"
#include "tests/skeleton/test_effects.h"
#include "tests/skeleton/test_models.h"

namespace palpate::skeleton {
namespace {

using testing::lattice_with_skin;
using testing::with_effects;
using testing::with_law;

constexpr double growth = 0.03;

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
    const State start = grown_start(model, growth);
    const Vec3 centre = model.spheres.front().center;
    EXPECT_EQ(Vec3(start.x.row(0)), centre);
    const std::vector<Link> links = grown(model.links, growth);
    for (std::size_t l = 0; l < links.size(); ++l) {
        EXPECT_DOUBLE_EQ(links[l].length, (1 + growth) * model.links[l].length);
        EXPECT_NEAR((start.x.row(links[l].b) - start.x.row(links[l].a)).norm(), links[l].length, 1e-12);
    }
    EXPECT_EQ(grown_start(model, 0).x, rest_state(model).x);
}

TEST(Growth, OfNothingLeavesPointsAsTheyHang) {
    const Model model = lattice_with_skin();
    const State rest = rest_state(model);
    for (const Attachment& point : model.skin) EXPECT_EQ(grown(point, rest, 0).rest, point.rest);
}

}  // namespace
}  // namespace palpate::skeleton
