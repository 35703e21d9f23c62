#include <gtest/gtest.h>

#include "fem/effects/material/anisotropy.h"
#include "fem/effects/material/inclusion.h"
#include "fem/effects/material/prestress.h"
#include "fem/effects/material/stiffening.h"
#include "skeleton/effects/link_effects.h"
#include "skeleton/links/placed/placed_links.h"
#include "skeleton/statics/equilibrium.h"
#include "tests/skeleton/test_effects.h"

namespace palpate::skeleton {
namespace {

using fem::Anisotropy;
using fem::Fibre;
using fem::Inclusion;
using fem::Prestress;
using fem::Stiffening;
using testing::at_sphere;
using testing::force_at;
using testing::make_chain;
using testing::make_lattice;
using testing::with_law;

// A bar of three links, as of a rod of 4 mm radius.
const Vec3 stiffness(2, 16, 20);
Model make_bar(int links = 3) { return make_chain(links, Vec3::UnitX(), stiffness); }

fem::Effects with_material(std::shared_ptr<const fem::MaterialEffect> effect) {
    return {.material = {std::move(effect)}};
}

Equilibrium equilibrium_of(const Model& model, const fem::Effects& effects, const Load& load) {
    return StaticsSolver(model, effects).solve(stiffness_vector(model), load, {1e-12});
}

// A couple about z on the last sphere.
Load couple(const Model& model, double moment) {
    const int last = static_cast<int>(model.spheres.size()) - 1;
    Load load;
    for (const double side : {1.0, -1.0})
        load.forces.push_back(
            {on_sphere(model, last, model.spheres[last].center + side * Vec3::UnitX()), {0, side * moment / 2, 0}});
    return load;
}

// --- Stiffening ---------------------------------------------------------------------------------------------------

TEST(StiffeningBar, FollowsYeohsUniaxialCurve) {
    const double c2 = 0.3, c3 = 1.5, kE = stiffness[0], L = 10, mu_area = kE * L / 3;
    Model bar = make_bar();
    for (Link& link : bar.links) link.stiffness[1] = 500;  // else it buckles where it is pressed
    for (const double F : {-3.0, 0.1, 4.0, 20.0, 60.0}) {
        const Equilibrium found =
            equilibrium_of(bar, with_material(std::make_shared<Stiffening>(c2, c3)), force_at(bar, 3, {F, 0, 0}));
        const double lambda = 1 + found.step[18] / (3 * L);
        const double x = lambda * lambda + 2 / lambda - 3;
        // Nominal stress 2 (lambda - lambda^-2) (2 C20 x + 3 C30 x^2), beyond the link's own. [Yeoh 1990]
        const double beyond = 2 * (lambda - 1 / (lambda * lambda)) * (2 * c2 * x + 3 * c3 * x * x);
        EXPECT_NEAR(kE * L * (lambda - 1) + mu_area * beyond, F, 1e-9 * std::abs(F)) << lambda;
        EXPECT_LT(found.step.segment<2>(19).norm(), 1e-9);
    }
}

TEST(StiffeningBar, IsThePlainOneInSmallStrain) {
    const fem::Effects effects = with_material(std::make_shared<Stiffening>(0.3, 1.5));
    const Model bar = make_bar(), linear = with_law(bar, EquilibriumLaw::linear);
    const Load load = force_at(bar, 3, {1, 0.1, 0});
    EXPECT_LT((equilibrium_of(linear, effects, load).step - equilibrium_of(linear, {}, load).step).norm(), 1e-12);
    const auto difference = [&](double share) {
        const Load part = force_at(bar, 3, share * Vec3(1, 0, 0));
        return (equilibrium_of(bar, effects, part).step - equilibrium_of(bar, {}, part).step).norm();
    };
    EXPECT_NEAR(difference(0.2) / difference(0.1), 8, 0.08);  // of third order; the fifth takes 0.06
}

TEST(StiffeningBar, StiffensInBending) {
    // Ends turned by +-phi/2: a fibre at y across is 1 - 2 y/L sin(phi/2) as long as it was.
    const double c2 = 0.3, c3 = 1.5, phi = 0.8, L = 10;
    const fem::Effects effects = with_material(std::make_shared<Stiffening>(c2, c3));
    const Model link = make_bar(1);
    State bent = rest_state(link);
    bent.R[0] = rotation({0, 0, -phi / 2});
    bent.R[1] = rotation({0, 0, phi / 2});
    const FibreOffsets offsets = fibre_offsets(link.links[0], Vec3::UnitX());
    double w = 0;
    for (int j = 0; j < fibres_per_link; ++j) {
        const double lambda = 1 - 2 * offsets[j].y() / L * std::sin(phi / 2);
        const double x = lambda * lambda + 2 / lambda - 3;
        w += fibre_weight * (c2 + c3 * x) * x * x;
    }
    const Vec3 stiffened = PlacedLinks(link, effects).terms(0, bent, false).energy;
    const Vec3 plain = PlacedLinks(link, {}).terms(0, bent, false).energy;
    EXPECT_NEAR((stiffened - plain).dot(stiffness), stiffness[0] * L * L / 3 * w, 1e-12 * stiffness[0]);
    EXPECT_EQ(stiffened[2], plain[2]);

    // So twice the couple turns the end by less than twice as much; without the effect it does exactly.
    const Model bar = make_bar();
    const auto angle = [&](const fem::Effects& all, double moment) {
        return equilibrium_of(bar, all, couple(bar, moment)).step[23];
    };
    EXPECT_LT(angle(effects, 8), 0.99 * angle({}, 8));
    EXPECT_NEAR(angle(effects, 0.1), angle({}, 0.1), 1e-4 * angle({}, 0.1));  // a share of (angle a link)^2
}

// --- Anisotropy ---------------------------------------------------------------------------------------------------

TEST(AnisotropicBar, HasTheFibresModulusBesides) {
    // Fibres of modulus k mu along the bar: Young's modulus grows from 3 mu to (3 + k) mu, in tension and in bending.
    const double k = 1.2;
    const fem::Effects effects = with_material(std::make_shared<Anisotropy>(std::vector<Fibre>{{k, {2, 0, 0}}}));
    const Model bar = with_law(make_bar(), EquilibriumLaw::linear);
    for (const Load& load : {force_at(bar, 3, {1, 0, 0}), couple(bar, 1)}) {
        const Eigen::VectorXd plain = equilibrium_of(bar, {}, load).step;
        EXPECT_LT((equilibrium_of(bar, effects, load).step - plain / (1 + k / 3)).norm(), 1e-12 * plain.norm());
    }
}

TEST(AnisotropicBar, FeelsFibresAcrossAQuarterAsMuch) {
    // Across, the strain of a bar that keeps its volume is half that along it: a quarter of the energy.
    const double k = 1.2;
    const fem::Effects effects = with_material(std::make_shared<Anisotropy>(std::vector<Fibre>{{k, {0, 1, 0}}}));
    const Model bar = with_law(make_bar(), EquilibriumLaw::linear);
    const Load load = force_at(bar, 3, {1, 0, 0});
    const Eigen::VectorXd plain = equilibrium_of(bar, {}, load).step;
    EXPECT_LT((equilibrium_of(bar, effects, load).step - plain / (1 + k / 12)).norm(), 1e-12 * plain.norm());
}

// --- Prestress ----------------------------------------------------------------------------------------------------

TEST(PrestressedBar, TakesItsOwnLength) {
    // Without a load: kE L (lambda - 1) + mu A s lambda = 0, mu A = kE L / 3.
    const double s = 0.3;
    const Model bar = make_bar();
    const fem::Effects effects = with_material(std::make_shared<Prestress>(Vec3(s, 0, 0).asDiagonal()));
    const Equilibrium found = equilibrium_of(bar, effects, {});
    for (int i = 1; i <= 3; ++i) EXPECT_NEAR(found.step[6 * i], 10 * i * (1 / (1 + s / 3) - 1), 1e-10);
    const Equilibrium linear = equilibrium_of(with_law(bar, EquilibriumLaw::linear), effects, {});
    EXPECT_NEAR(linear.step[18], -30 * (s / 3) / (1 + s / 3), 1e-10);
}

TEST(PrestressedBar, PullsItsClampsAndMovesNothingBetween) {
    Model bar = make_bar();
    bar.spheres[3].held = true;
    const double s = 0.3;
    const fem::Effects effects = with_material(std::make_shared<Prestress>(Vec3(s, 0, 0).asDiagonal()));
    for (const EquilibriumLaw law : {EquilibriumLaw::linear, EquilibriumLaw::large_rotation}) {
        const Equilibrium found = equilibrium_of(with_law(bar, law), effects, {});
        EXPECT_LT(found.step.norm(), 1e-12);
        const Eigen::VectorXd f = link_forces(with_law(bar, law), found, effects) * stiffness_vector(bar);
        EXPECT_NEAR(f[0], 2 * 10 * s / 3, 1e-12);  // on the first sphere, towards the others
    }
}

// --- Inclusion ----------------------------------------------------------------------------------------------------

// A part with a sharp border.
class Part : public fem::MaterialEffect {
public:
    Part(std::function<bool(const Vec3&)> holds, double ratio) : holds_(std::move(holds)), ratio_(ratio) {}
    double stiffness(const Vec3& X) const override { return holds_(X) ? ratio_ : 1; }
    bool is_scale() const override { return true; }

private:
    std::function<bool(const Vec3&)> holds_;
    double ratio_;
};

TEST(InclusionInLinks, IsScaledStiffness) {
    // Of the second of three links.
    const Model bar = make_bar();
    Eigen::VectorXd k = stiffness_vector(bar);
    k.segment<3>(3) *= 6;
    const auto part = std::make_shared<Part>([](const Vec3& X) { return X.x() > 10 && X.x() < 20; }, 6);
    const Load load = force_at(bar, 3, {0.5, 0.1, -0.1});
    for (const EquilibriumLaw law : {EquilibriumLaw::linear, EquilibriumLaw::large_rotation}) {
        const Model tested = with_law(bar, law);
        const Eigen::VectorXd scaled = StaticsSolver(tested).solve(k, load, {1e-12}).step;
        // Forces known to 1e-12 of 0.5 N, over the softness of a chain.
        EXPECT_LT((equilibrium_of(tested, with_material(part), load).step - scaled).norm(), 1e-9);
    }
}

TEST(InclusionInLinks, ScalesAllThatBelongsToALink) {
    const Model model = make_lattice({4, 2, 2});
    const fem::Effects effects{.material = {std::make_shared<Stiffening>(0.5, 1)},
                               .of_model = {in_links({.torsion = 0.3, .shear = 0.2})}};
    fem::Effects scaled = effects;
    scaled.material.push_back(std::make_shared<Inclusion>(Inclusion::sphere({0, 0, 0}, 1e3, 6)));
    Load load = force_at(model, 3, {1, 2, -3});
    const Eigen::VectorXd step = equilibrium_of(model, effects, load).step;
    load.forces[0].force *= 6;
    EXPECT_LT((equilibrium_of(model, scaled, load).step - step).norm(), 1e-9);
}

TEST(InclusionInLinks, SlicesOfALinkGiveWayOneAfterAnother) {
    // Half of a link five times as stiff: its softness is 1/2 + 1/2 / 5.
    const Model bar = with_law(make_bar(1), EquilibriumLaw::linear);
    const Load load = force_at(bar, 1, {1, 0, 0});
    const auto part = std::make_shared<Part>([](const Vec3& X) { return X.x() > 2.5 && X.x() < 7.5; }, 5);
    const double plain = equilibrium_of(bar, {}, load).step[6];
    EXPECT_NEAR(equilibrium_of(bar, with_material(part), load).step[6], plain * 0.6, 1e-12);
}

TEST(InclusionInLinks, CountsForWhatItFillsOfASection) {
    // A half of the fibres ten times as stiff.
    const Model bar = with_law(make_bar(1), EquilibriumLaw::linear);
    const Load load = force_at(bar, 1, {1, 0, 0});
    const auto part = std::make_shared<Part>([](const Vec3& X) { return X.y() + 0.3 * X.z() > 0; }, 10);
    const double plain = equilibrium_of(bar, {}, load).step[6];
    EXPECT_NEAR(equilibrium_of(bar, with_material(part), load).step[6], plain / 5.5, 1e-12);
}

}  // namespace
}  // namespace palpate::skeleton
