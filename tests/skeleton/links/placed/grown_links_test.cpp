// Links whose material has grown unevenly: as long as their sections' mean, and curved away from what has grown most.

#include "skeleton/links/placed/grown_links.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <numbers>

#include "skeleton/links/placed/placed_links.h"
#include "skeleton/statics/equilibrium.h"
#include "tests/skeleton/test_effects.h"
#include "tests/skeleton/test_models.h"

namespace palpate::skeleton {
namespace {

using testing::make_full_lattice;
using testing::with_effects;
using testing::with_law;

constexpr double link_length = 10, bar_radius = 4;  // of a link, and of a round section [mm]

/// A round bar along x, of full links, clamped at its start.
Model make_round_bar(int links) {
    Model model = testing::make_chain(links);
    const double A = std::numbers::pi * bar_radius * bar_radius, I = A * bar_radius * bar_radius / 4, E = 0.3;
    const double k = E * I / link_length, across = 12 * k / (link_length * link_length);
    for (Link& link : model.links) {
        link.section = LinkSection{(link.a + 0.5) * link_length * Vec3::UnitX(), Mat3::Identity(), A};
        link.gyration = bar_radius / 2;
        link.stiffness.resize(6);
        link.stiffness << E * A / link_length, k, 0.7 * k, k, across, across;
    }
    return model;
}

EffectRecord local_swelling(const Vec3& centre, double reach, double growth) {
    return {"local-swelling",
            {{"cx", centre.x(), "mm"},
             {"cy", centre.y(), "mm"},
             {"cz", centre.z(), "mm"},
             {"radius", reach, "mm"},
             {"growth", growth, "1"}}};
}

// The free end of the bar's axis that has grown by g(x, y), y towards +y: slopes by integration over the discs and
// along the axis, small turns.
Vec3 end_of_curved_axis(const fem::Growth& growth, double length, const Vec3& side) {
    constexpr int along = 600, rings = 24, spokes = 48;
    Vec3 end = Vec3::Zero();
    double slope = 0;
    for (int i = 0; i < along; ++i) {
        const double x = (i + 0.5) * length / along;
        double mean = 0, first = 0, second = 0;
        for (int r = 0; r < rings; ++r)
            for (int k = 0; k < spokes; ++k) {
                const double rho = bar_radius * std::sqrt((r + 0.5) / rings), phi = 2 * std::numbers::pi * k / spokes;
                const double y = rho * std::cos(phi);
                const double g = growth.at(Vec3(x, 0, 0) + y * side + rho * std::sin(phi) * Vec3::UnitX().cross(side));
                mean += g / (rings * spokes);
                first += g * y / (rings * spokes);
                second += y * y / (rings * spokes);
            }
        const double turn = -first / second * length / along;
        end.x() += (1 + mean) * length / along;
        end += (slope + 0.5 * turn) * length / along * side;
        slope += turn;
    }
    return end;
}

TEST(GrownLinks, CurveAwayFromTheSideThatHasGrown) {
    constexpr int links = 6;
    for (const Vec3& side : {Vec3(0, 1, 0), Vec3(0, 0, 1), Vec3(0, -0.6, 0.8)}) {
        for (const EquilibriumLaw law : {EquilibriumLaw::linear, EquilibriumLaw::large_rotation}) {
            const EffectRecord effect = local_swelling(Vec3(27, 0, 0) + 6 * side, 6, 0.01);
            const Model bar = with_effects(with_law(make_round_bar(links), law), {effect});
            const Vec3 end = equilibrium(bar, {}).state.x.row(links).transpose();
            const Vec3 expected = end_of_curved_axis(physics_of({effect}).growth, links * link_length, side),
                       moved = expected - links * link_length * Vec3::UnitX();
            EXPECT_GT(-expected.dot(side), 0.3);
            // Twelve places in a section and eight along a link stand for all of it; turns of 0.01 are small to 1e-4.
            EXPECT_LT((end - expected).norm(), 0.02 * moved.norm()) << side.transpose();
        }
    }
}

TEST(GrownLinks, StayStraightWhereTheyHaveGrownEvenlyAbout) {
    const Model bar = with_effects(make_round_bar(6), {local_swelling({27, 0, 0}, 6, 0.05)});
    const Equilibrium found = equilibrium(bar, {});
    EXPECT_GT(found.state.x(6, 0), 60.2);
    EXPECT_LT(found.state.x.rightCols<2>().cwiseAbs().maxCoeff(), 1e-9);
}

TEST(GrownLinks, AreStrainlessByThemselvesTheirFibresToo) {
    const Model model = make_full_lattice({3, 3, 2});
    fem::Effects effects;
    effects.growth.parts.push_back({{model.spheres.front().center + Vec3(4, 2, 1), 8}, 0.4});
    const fem::Effects stiffening = physics_of({{"stiffening", {{"c2", 3, "1"}, {"c3", 30, "1"}}}});
    effects.material = stiffening.material;
    const PlacedLinks links(model, effects);
    const std::vector<LinkPose> natural = natural_poses(model, grown_links(model, effects.growth));
    double bent = 0;
    for (std::size_t l = 0; l < model.links.size(); ++l) {
        const LinkTerms terms = links.terms(l, natural[l], false);
        EXPECT_LT(terms.gradient.norm(), 1e-10) << l;
        bent = std::max(bent, (natural[l].R_b - Mat3::Identity()).norm());
    }
    EXPECT_GT(bent, 0.01);
}

TEST(GrownLinks, AreNoLessStableInTheLinearLawHoweverMuchTheyCurve) {
    // What curves a link does not strain it where the linear law takes its stiffness: a rigid turn is free, all else is
    // not.
    const Model bar = make_round_bar(6);
    const PlacedLinks links(bar, physics_of({local_swelling({27, 6, 0}, 6, 3)}));
    for (std::size_t l = 0; l < bar.links.size(); ++l) {
        const Mat12 H = links.linear_hessian(l, bar.links[l].stiffness);
        const Eigen::VectorXd eigenvalues = Eigen::SelfAdjointEigenSolver<Mat12>(H).eigenvalues();
        EXPECT_GT(eigenvalues.minCoeff(), -1e-12 * eigenvalues.maxCoeff()) << l;
        EXPECT_GT(eigenvalues[6], 1e-4 * eigenvalues.maxCoeff()) << l;
    }
}

TEST(GrownLinks, OfThePaperGrowAlongTheirAxes) {
    const fem::Growth part{.parts = {{{Vec3(25, 3, 0), 8}, 0.2}}};
    const Model model = testing::make_chain(6);
    const std::vector<Link> grown = grown_links(model, part);
    for (std::size_t l = 0; l < grown.size(); ++l) {
        const Vec3 a = model.spheres[grown[l].a].center, b = model.spheres[grown[l].b].center;
        EXPECT_DOUBLE_EQ(grown[l].length, (1 + part.between(a, b)) * link_length);
    }
}

}  // namespace
}  // namespace palpate::skeleton
