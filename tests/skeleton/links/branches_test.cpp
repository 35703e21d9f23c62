#include "skeleton/links/branches.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "skeleton/statics/equilibrium.h"
#include "skeleton/statics/statics.h"
#include "tests/skeleton/test_models.h"

namespace palpate::skeleton {
namespace {

using testing::add_link;
using testing::force_at;
using testing::make_chain;
using testing::make_lattice;
using testing::sphere_at;

std::vector<char> moves_of(const Model& model) {
    std::vector<char> moves;
    for (const Sphere& sphere : model.spheres) moves.push_back(sphere.held ? 0 : 1);
    return moves;
}

Branches branches_of(const Model& model) { return {model.links, moves_of(model)}; }

TEST(Branches, GoOutwardsFromWhatIsHeld) {
    // a chain of 4 links with a twig of two at its middle, links numbered any way round
    Model model = make_chain(4);
    for (const double y : {10.0, 20.0}) model.spheres.push_back(sphere_at(Vec3(20, y, 0), false));
    add_link(model, 6, 5, Vec3(2, 300, 200));
    add_link(model, 5, 2, Vec3(2, 300, 200));
    std::ranges::reverse(model.links);
    const Branches branches = branches_of(model);
    ASSERT_EQ(branches.tree_edges().size(), 6u);
    std::vector<char> known = moves_of(model);
    for (char& it : known) it = it == 0 ? 1 : 0;
    for (const auto& [sphere, near] : branches.tree_edges()) {
        EXPECT_TRUE(known[near]);
        EXPECT_FALSE(known[sphere]);
        known[sphere] = 1;
    }
}

TEST(Branches, AreNoneWhereThereIsALoop) {
    EXPECT_TRUE(branches_of(make_lattice({3, 2, 2})).empty());
    Model ring = make_chain(5);
    add_link(ring, 5, 2, Vec3(2, 300, 200));
    EXPECT_TRUE(branches_of(ring).empty());
    Model between = make_chain(5);  // a path from one held sphere to another
    between.spheres.back().held = true;
    EXPECT_TRUE(branches_of(between).empty());
    Model adrift = make_chain(5);  // as many links as spheres that move, some of them on nothing
    adrift.links.erase(adrift.links.begin() + 2);
    add_link(adrift, 3, 5, Vec3(2, 300, 200));
    EXPECT_TRUE(branches_of(adrift).empty());
}

TEST(Branches, AStepIsTheSameToFirstOrderAndATurnKeepsLengths) {
    const Vec3 arm(10, -3, 5), parts(0.3, 0.7, -0.2), turns(0.2, -0.5, 0.9);
    for (const double h : {1e-3, 1e-4}) {
        const Vec3 off = Branches::carried(arm, parts, turns, h) - (arm + h * parts);
        EXPECT_LT(off.norm(), 10 * h * h);  // |w|^2 |a| / 2 and |w| |d|
    }
    EXPECT_NEAR(Branches::carried(arm, turns.cross(arm), turns, 2).norm(), arm.norm(), 1e-12);
}

TEST(Branches, ALongChainBendsFarInFewSteps) {
    // steps went by the hundred, each of them limited by how much it stretched the links
    for (const int links : {30, 300}) {
        const Model model = make_chain(links);
        StaticsSolver solver(model);
        const double length = 10.0 * links;
        // a tip force that moves a cantilever of the links' bending stiffness by a third of its length
        const double bending = 10 * model.links.front().stiffness[1];
        const Load load = force_at(model, links, Vec3(0, 0, bending / (length * length)));
        const Equilibrium at = solver.solve(stiffness_vector(model), load);
        const double moved = at.state.x.row(links).z() - model.spheres[links].center.z();
        EXPECT_GT(moved, 0.2 * length);
        EXPECT_LE(at.iterations, 20) << links;
        // and is the equilibrium
        EXPECT_LT(residual(model, at.state, load).tail<6>().norm(), 1e-6 * load.forces.front().force.norm());
    }
}

}  // namespace
}  // namespace palpate::skeleton
