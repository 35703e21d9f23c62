#include "skeleton/effects/effect.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "mesh/errors.h"
#include "skeleton/effects/compliant_support.h"
#include "skeleton/effects/gravity.h"
#include "skeleton/effects/placed_effects.h"
#include "test_models.h"

namespace palpate::skeleton {
namespace {

using testing::at_sphere;
using testing::force_at;
using testing::make_chain;
using testing::make_lattice;
using testing::random_state;

Effect gravity(const Vec3& g) {
    return {"gravity", {{"gx", g.x(), "mm/s^2"}, {"gy", g.y(), "mm/s^2"}, {"gz", g.z(), "mm/s^2"}}};
}

Effect compliant_support(double stiffness) { return {"compliant-support", {{"stiffness", stiffness, "N/mm"}}}; }

Model with_law(Model model, Law law) {
    model.law = law;
    return model;
}

Model with_effects(Model model, std::vector<Effect> effects) {
    model.effects = std::move(effects);
    return model;
}

// A potential with all derivatives: e = a/2 |u|^2 + b exp(n . u), u = x - X. Parameters: a, b.
class Slope : public fem::PointPotential {
public:
    Slope(double a, double b) : a_(a), b_(b) {}
    fem::ActsOn acts_on() const override { return fem::ActsOn::surface; }
    fem::PointTerms terms(const Vec3& X, const Vec3& x, bool with_parameters) const override {
        const Vec3 u = x - X, n(0.1, -0.05, 0.02);
        const double e = std::exp(n.dot(u));
        fem::PointTerms terms{.energy = 0.5 * a_ * u.squaredNorm() + b_ * e,
                              .gradient = a_ * u + b_ * e * n,
                              .hessian = a_ * Mat3::Identity() + b_ * e * n * n.transpose(),
                              .by_parameter = {}};
        if (with_parameters) {
            terms.by_parameter.resize(3, 2);
            terms.by_parameter << u, e * n;
        }
        return terms;
    }

private:
    double a_, b_;
};

// A lattice in a box of skin, which hangs on links, on spheres, and once on two spheres that no link joins.
Model lattice_with_skin() {
    Model model = make_lattice({4, 2, 2});
    model.surface = mesh::make_box({-4, -4, -4}, {34, 14, 14}, {4, 4, 4});
    for (const auto& vertex : model.surface.vertices.rowwise()) model.skin.push_back(attach(model, vertex.transpose()));
    model.skin[5].a = 0;
    model.skin[5].b = 15;
    model.skin[5].t = 0.4;
    model.supports = {mesh::PlaneRegion{{-4, 0, 0}, {1, 0, 0}, 0.1}};
    return model;
}

// --- Forces and tangents ------------------------------------------------------------------------------------------

// All of what a model is under: its own effects and one that no file knows.
struct InForce {
    std::string name;
    std::vector<Effect> effects;
    fem::Potentials extra;
};

class EachEffect : public ::testing::TestWithParam<InForce> {
protected:
    const Model model = with_effects(lattice_with_skin(), GetParam().effects);
    const fem::Potentials& extra = GetParam().extra;
    const PlacedEffects extras{model, extra};
    Load load = force_at(model, 3, {1, 2, -3});

    double energy(const State& state) const { return potential(model, state, load) + extras.energy(state).sum; }
    Eigen::VectorXd net(const State& state) const { return residual(model, state, load) + extras.force(state); }
    Eigen::MatrixXd whole_tangent(const State& state) const {
        Eigen::MatrixXd J = tangent(model, state, load);
        const auto blocks = extras.curvature(state);
        for (size_t p = 0; p < blocks.size(); ++p) {
            const auto [a, b] = extras.pairs()[p];
            J.block<6, 6>(6 * a, 6 * b) += blocks[p];
            if (a != b) J.block<6, 6>(6 * b, 6 * a) += blocks[p].transpose();
        }
        return J;
    }
    bool is_free(int sphere) const {
        return !model.spheres[sphere].held || fem::release_supports(potentials_of(model.effects)) ||
               fem::release_supports(extra);
    }
};

TEST_P(EachEffect, ForceIsMinusTheEnergysDerivative) {
    std::mt19937_64 engine(7);
    const State state = random_state(model, engine, 2, 0.6);
    const Eigen::VectorXd r = net(state);
    const double h = 1e-5;
    for (int j = 0; j < model.dofs(); ++j) {
        const Eigen::VectorXd step = h * Eigen::VectorXd::Unit(model.dofs(), j);
        const double slope = (energy(advance(state, step)) - energy(advance(state, -step))) / (2 * h);
        // Rounding of an energy of some 1e4 over h is 1e-7; h^2 times third derivatives of 1e4 as much.
        EXPECT_NEAR(r[j], -slope, 3e-6) << j;
    }
}

TEST_P(EachEffect, TangentIsTheForcesDerivative) {
    std::mt19937_64 engine(8);
    const State state = random_state(model, engine, 2, 0.6);
    const Eigen::MatrixXd J = whole_tangent(state);
    Eigen::MatrixXd D(model.dofs(), model.dofs());
    const double h = 1e-5;
    for (int j = 0; j < model.dofs(); ++j) {
        const Eigen::VectorXd step = h * Eigen::VectorXd::Unit(model.dofs(), j);
        D.col(j) = (net(advance(state, -step)) - net(advance(state, step))) / (2 * h);
    }
    EXPECT_LT((J - J.transpose()).norm(), 1e-13 * J.norm());  // rounding
    // Differences of torques see turned frames: their symmetric part is the derivative in exponential coordinates.
    EXPECT_LT((J - 0.5 * (D + D.transpose())).norm(), 1e-8 * J.norm());
}

TEST_P(EachEffect, EquilibriumBalancesAllForces) {
    StaticsSolver solver(model, extra);
    const Equilibrium found = solver.solve(stiffness_vector(model), load);
    const Eigen::VectorXd r = net(found.state);
    for (int i = 0; i < static_cast<int>(model.spheres.size()); ++i) {
        if (is_free(i))
            EXPECT_LT(r.segment<6>(6 * i).norm(), 1e-6) << i;  // 1e-9 of loads of some 10 N, over 10 mm
        else
            EXPECT_EQ(found.step.segment<6>(6 * i).norm(), 0);
    }
    EXPECT_LT(energy(found.state), energy(rest_state(model)));
}

TEST_P(EachEffect, SolverFactorsTheWholeTangent) {
    StaticsSolver solver(model, extra);
    const Equilibrium found = solver.solve(stiffness_vector(model), load);
    Eigen::VectorXd b = Eigen::VectorXd::LinSpaced(model.dofs(), -1, 1);
    const Eigen::VectorXd x = solver.solve_tangent(b);
    const Eigen::VectorXd left = whole_tangent(found.state) * x - b;
    for (int i = 0; i < static_cast<int>(model.spheres.size()); ++i) {
        if (is_free(i))
            EXPECT_LT(left.segment<6>(6 * i).norm(), 1e-9) << i;  // rounding, condition of some 1e5
        else
            EXPECT_EQ(x.segment<6>(6 * i).norm(), 0);
    }
}

TEST_P(EachEffect, LinearLawIsLinearInTheLoad) {
    const Model linear = with_law(model, Law::linear);
    StaticsSolver solver(linear, extra);
    const Eigen::VectorXd k = stiffness_vector(model);
    const Equilibrium unloaded = solver.solve(k, {}), once = solver.solve(k, load);
    Load tenfold = load;
    tenfold.forces[0].force *= 10;
    const Equilibrium ten = solver.solve(k, tenfold);
    const Eigen::VectorXd moved = once.step - unloaded.step;
    EXPECT_GT(moved.norm(), 1e-2);
    EXPECT_LT((ten.step - unloaded.step - 10 * moved).norm(), 1e-10 * ten.step.norm());  // rounding
    EXPECT_LT(ten.residual, 1e-9);

    // Steps under forces alone are what loads add to the effects' own.
    const Eigen::MatrixXd F = external_force(model, rest_state(model), load);
    EXPECT_LT((solver.linear_steps(k, F).col(0) - moved).norm(), 1e-10 * moved.norm());
}

INSTANTIATE_TEST_SUITE_P(Effects, EachEffect,
                         ::testing::Values(InForce{"None", {}, {}}, InForce{"Gravity", {gravity({100, -2e5, 9e5})}, {}},
                                           InForce{"CompliantSupport", {compliant_support(8)}, {}},
                                           InForce{"Skin", {}, {std::make_shared<Slope>(2e-3, 0.02)}},
                                           InForce{"All",
                                                   {compliant_support(8), gravity({100, -2e5, 9e5}), {"outliers", {}}},
                                                   {std::make_shared<Slope>(2e-3, 0.02)}}),
                         [](const auto& tested) { return tested.param.name; });

TEST(EffectsByTheLinearLaw, AreTheLimitOfSmallDisplacements) {
    const Model model = with_effects(lattice_with_skin(), {gravity({100, -2e5, 9e5})});
    const fem::Potentials extra{std::make_shared<Slope>(2e-3, 0.02)};
    const Load load = force_at(model, 3, {1, 2, -3});
    const auto difference = [&](double times) {
        const Eigen::VectorXd k = times * stiffness_vector(model);
        const Eigen::VectorXd large = StaticsSolver(model, extra).solve(k, load, {1e-13}).step;
        const Eigen::VectorXd linear = StaticsSolver(with_law(model, Law::linear), extra).solve(k, load).step;
        return (large - linear).norm() / linear.norm();
    };
    // The first term left out is of second order: twice the stiffness, half the relative difference.
    EXPECT_LT(difference(1e3), 3e-3);
    EXPECT_NEAR(difference(1e3) / difference(2e3), 2, 0.1);
}

// d observe / d parameters = P J^-1 effect_forces, against differences of whole equilibria.
class EffectForces : public ::testing::TestWithParam<Law> {
protected:
    using Make = std::function<std::shared_ptr<const fem::PointPotential>(const Eigen::VectorXd&)>;

    void expect_sensitivity(const Make& make, const Eigen::VectorXd& parameters) const {
        const Model model = with_law(lattice_with_skin(), GetParam());
        const Eigen::VectorXd k = stiffness_vector(model);
        const Load load = force_at(model, 3, {1, 2, -3});
        const auto equilibrium_at = [&](const Eigen::VectorXd& p) {
            return StaticsSolver(model, {make(p)}).solve(k, load, {1e-13});
        };
        StaticsSolver solver(model, {make(parameters)});
        const Equilibrium found = solver.solve(k, load, {1e-13});
        const Eigen::MatrixXd A = observation_jacobian(model, found, model.skin) *
                                  solver.solve_tangent(effect_forces(model, found, *make(parameters)));
        ASSERT_EQ(A.cols(), parameters.size());
        for (Eigen::Index p = 0; p < parameters.size(); ++p) {
            const double h = 1e-4 * parameters.norm();
            const Eigen::VectorXd change = h * Eigen::VectorXd::Unit(parameters.size(), p);
            const Points difference = observe(model, equilibrium_at(parameters + change), model.skin) -
                                      observe(model, equilibrium_at(parameters - change), model.skin);
            const Eigen::Map<const Eigen::VectorXd> flat(difference.data(), difference.size());
            // h^2 relative, equilibria known to some 1e-12 mm over h; the linear law's own difference errs by 1e-5.
            EXPECT_LT((flat / (2 * h) - A.col(p)).norm(), 2e-5 * A.col(p).norm()) << p;
        }
    }
};

TEST_P(EffectForces, GiveTheSensitivityToGravity) {
    expect_sensitivity([](const auto& p) { return std::make_shared<Gravity>(Vec3(p)); }, Vec3(100, -2e5, 3e5));
}

TEST_P(EffectForces, GiveTheSensitivityToASupportsStiffness) {
    expect_sensitivity([](const auto& p) { return std::make_shared<CompliantSupport>(std::exp(p[0])); },
                       Eigen::VectorXd::Constant(1, std::log(8.0)));
}

TEST_P(EffectForces, GiveTheSensitivityOnTheSkin) {
    expect_sensitivity([](const auto& p) { return std::make_shared<Slope>(p[0], p[1]); }, Eigen::Vector2d(2e-3, 0.02));
}

INSTANTIATE_TEST_SUITE_P(Laws, EffectForces, ::testing::Values(Law::linear, Law::large_rotation));

// --- Gravity ------------------------------------------------------------------------------------------------------

TEST(GravityEffect, IsTheSameAsAKnownOne) {
    const Vec3 g(300, -4e5, 5e5);
    const Model model = make_lattice({4, 2, 2}), heavy = with_effects(model, {gravity(g)});
    Load load = force_at(model, 3, {1, 2, -3}), with_weight = load;
    with_weight.gravity = g;
    std::mt19937_64 engine(3);
    const State state = random_state(model, engine, 2, 0.6);
    EXPECT_EQ(effect_force(heavy, state) + external_force(model, state, load),
              external_force(model, state, with_weight));
    for (const Law law : {Law::linear, Law::large_rotation}) {
        const Eigen::VectorXd step = equilibrium(with_law(heavy, law), load, {1e-12}).step;
        // Forces known to 1e-12 of 4 N over stiffnesses of 1 N/mm.
        EXPECT_LT((step - equilibrium(with_law(model, law), with_weight, {1e-12}).step).norm(), 1e-9);
    }
}

TEST(GravityEffect, IsAddedToAKnownOne) {
    const Model model = with_effects(make_chain(5, -Vec3::UnitZ()), {gravity({0, 0, -9810})});
    Load load;
    load.gravity = {0, 0, 9810};
    EXPECT_LT(equilibrium(model, load).step.norm(), 1e-12);
}

TEST(GravityEffect, HangsOnTheSupport) {
    const Model model = with_effects(make_lattice({5, 2, 2}), {gravity({0, 0, -9e5})});
    const Equilibrium found = equilibrium(model, {});  // nothing else: it must converge by itself
    EXPECT_LT(found.residual, 1e-8);
    const Eigen::VectorXd r = residual(model, found.state, {});
    Vec3 reaction = Vec3::Zero();
    double mass = 0;
    for (size_t i = 0; i < model.spheres.size(); ++i) {
        mass += model.spheres[i].mass;
        if (model.spheres[i].held) reaction -= r.segment<3>(6 * i);
    }
    EXPECT_LT((reaction - mass * Vec3(0, 0, 9e5)).norm(), 1e-7);  // 20 spheres, each known to 1e-9 of a newton
}

TEST(GravityEffect, IsPutOnStepByStepWhereItMust) {
    const Model model = with_effects(make_chain(20), {gravity({0, 0, -3e5})});
    const Equilibrium whole = equilibrium(model, {});
    const int few = whole.iterations - 1;  // too few for all of it at once
    const Equilibrium in_steps = equilibrium(model, {}, {1e-9, few});
    EXPECT_GT(in_steps.iterations, few);
    EXPECT_LT((in_steps.step - whole.step).norm(), 1e-4);  // 1e-9 of 0.3 N over the softness of a chain of 20
}

// --- A support that gives way -------------------------------------------------------------------------------------

TEST(CompliantSupportEffect, GivesWayByForceOverStiffness) {
    // The springs bear all forces, so the mean of their points moves by F / k, whatever the body does.
    const double k = 5;
    for (const Law law : {Law::linear, Law::large_rotation}) {
        const Model model =
            with_law(with_effects(lattice_with_skin(), {compliant_support(k), gravity({0, 0, -1e5})}), law);
        const Vec3 F(1, 2, -3);
        const Equilibrium found = equilibrium(model, force_at(model, 3, F));
        const PointSet support = point_set(model, fem::ActsOn::support);
        const Points moved = observe(model, found, support.at) - observe(model, rest_state(model), support.at);
        const Vec3 weight = 16 * 1e-6 * Vec3(0, 0, -1e5);
        EXPECT_LT((moved.transpose() * support.weights - (F + weight) / k).norm(), 1e-8);  // 1e-9 of 3 N, over k
    }
}

TEST(CompliantSupportEffect, CarriesTheBodyAlong) {
    const Model model = with_effects(make_chain(3), {compliant_support(0.1)});
    const Equilibrium found = equilibrium(model, force_at(model, 3, {0.5, 0, 0}));
    for (int i = 0; i <= 3; ++i) EXPECT_NEAR(found.step[6 * i], 0.5 / 0.1 + i * 0.5 / 2, 1e-7);  // F / k, F / kE a link
}

TEST(CompliantSupportEffect, TurnsUnderACouple) {
    // Of six points two lie on the axis: k / 6 r^2 sin(theta) each for the other four, against F a cos(theta).
    const double k = 3, r = 4, F = 2, arm = 3;
    for (const Law law : {Law::linear, Law::large_rotation}) {
        const Model model = with_law(with_effects(make_chain(1), {compliant_support(k)}), law);
        Load load;
        load.forces.push_back({{0, 0, 0, {arm, 0, 0}}, {0, F, 0}});
        const Equilibrium found = equilibrium(model, load);
        const double theta = found.step[5], tangent_of_it = F * arm / (4.0 / 6 * k * r * r);
        EXPECT_NEAR(law == Law::linear ? theta : std::tan(theta), tangent_of_it, 1e-8);
        EXPECT_NEAR(found.step[1], F / k, 1e-8);
    }
}

TEST(CompliantSupportEffect, OfGreatStiffnessHolds) {
    for (Model model : {make_lattice({4, 2, 2}), lattice_with_skin()}) {
        const Load load = force_at(model, 3, {1, 2, -3});
        const Eigen::VectorXd held = equilibrium(model, load, {1e-12}).step;
        const auto difference = [&](double k) {
            return (equilibrium(with_effects(model, {compliant_support(k)}), load).step - held).norm();
        };
        EXPECT_LT(difference(1e6), 1e-3);                         // 4 N on arms of 30 mm against 1e6 N/mm
        EXPECT_NEAR(difference(1e5) / difference(1e6), 10, 0.5);  // to first order in 1 / k
    }
}

TEST(CompliantSupportEffect, SpringsInParallelAdd) {
    const Model model = lattice_with_skin();
    const Load load = force_at(model, 3, {1, 2, -3});
    const Eigen::VectorXd step = equilibrium(with_effects(model, {compliant_support(5)}), load).step;
    const Model two = with_effects(model, {compliant_support(2), compliant_support(3)});
    EXPECT_LT((equilibrium(two, load).step - step).norm(), 1e-6);  // forces known to 1e-9 of 4 N
}

// --- Points that effects act on -----------------------------------------------------------------------------------

TEST(PointSets, MaterialWeighsWhatTheBodyWeighs) {
    const PointSet set = point_set(make_lattice({3, 2, 2}), fem::ActsOn::material);
    EXPECT_EQ(set.at.size(), 12u);
    EXPECT_NEAR(set.weights.sum(), 12e-6, 1e-18);
}

TEST(PointSets, SurfaceHasTheSkinsArea) {
    const Model model = lattice_with_skin();
    const PointSet set = point_set(model, fem::ActsOn::surface);
    EXPECT_EQ(set.at.size(), model.skin.size());
    EXPECT_NEAR(set.weights.sum(), mesh::area(model.surface), 1e-9);
}

TEST(PointSets, SupportIsItsSkinOnTheNearestHeldSpheres) {
    const Model model = lattice_with_skin();
    const PointSet set = point_set(model, fem::ActsOn::support);
    EXPECT_NEAR(set.weights.sum(), 1, 1e-14);
    EXPECT_EQ(set.at.size(), 25u);  // 5 x 5 vertices of one side: some for each of the four spheres, not in line
    for (const Attachment& point : set.at) {
        EXPECT_EQ(point.rest.x(), -4);
        EXPECT_EQ(point.a, point.b);
        ASSERT_TRUE(model.spheres[point.a].held);
        for (const Sphere& sphere : model.spheres) {
            if (!sphere.held) continue;
            EXPECT_LE((model.spheres[point.a].center - point.rest).norm(), (sphere.center - point.rest).norm());
        }
    }
}

TEST(PointSets, AHeldSphereThatItsSkinDoesNotKeepFromTurningBearsSixPointsMore) {
    Model model = lattice_with_skin();
    const auto extent = [&] {
        const PointSet set = point_set(model, fem::ActsOn::support);
        int on_axes = 0;
        for (const Attachment& point : set.at)
            on_axes += std::abs((point.rest - model.spheres[point.a].center).norm() - 4) < 1e-12;
        EXPECT_NEAR(set.weights.sum(), 1, 1e-14);
        return on_axes;
    };
    EXPECT_EQ(extent(), 0);
    model.supports = {mesh::SphereRegion{{-4, -4, -4}, 1}};  // one corner, on one of four held spheres
    EXPECT_EQ(extent(), 4 * 6);
    model.supports = {};
    EXPECT_EQ(extent(), 4 * 6);
}

TEST(PointSets, AHeldSphereWithoutLinksBearsNothingAndStays) {
    Model model = make_chain(2);
    model.spheres.push_back(testing::sphere_at({0, 30, 0}, true));
    for (const Attachment& point : point_set(model, fem::ActsOn::support).at) EXPECT_EQ(point.a, 0);
    const Equilibrium found = equilibrium(with_effects(model, {compliant_support(1)}), force_at(model, 2, {1, 0, 0}));
    EXPECT_NEAR(found.step[0], 1, 1e-8);
    EXPECT_EQ(found.step.segment<6>(18).norm(), 0);
}

// --- Messages -----------------------------------------------------------------------------------------------------

std::string message_of(const std::function<void()>& call) {
    try {
        call();
    } catch (const InvalidInput& error) {
        return error.what();
    }
    return "nothing was thrown";
}

std::string complaint(const Effect& effect) {
    return message_of([&] { make_potential(effect); });
}

TEST(EffectMessages, EveryFaultIsNamed) {
    EXPECT_EQ(complaint({"gravitty", {}}),
              "effect 'gravitty' is not known (did you mean 'gravity'?); known are 'gravity', 'compliant-support', "
              "'misalignment', 'force-gain', 'outliers'");
    EXPECT_EQ(complaint({"outliers", {}}),
              "effect 'outliers' is about the measurement, not the body: no model can play it");
    EXPECT_EQ(complaint({"gravity", {{"gx", 0, ""}, {"gy", 0, ""}}}),
              "effect 'gravity': the parameter 'gz' [mm/s^2] is missing");
    EXPECT_EQ(
        complaint({"compliant-support", {{"stifness", 3, "N/mm"}}}),
        "effect 'compliant-support': the parameter 'stifness' is not known (did you mean 'stiffness'?); known are "
        "'stiffness'");
    EXPECT_EQ(complaint(compliant_support(0)), "effect 'compliant-support': stiffness is 0 N/mm, but must be above 0");
    EXPECT_EQ(complaint(gravity({0, std::nan(""), 0})), "effect 'gravity': gy is nan mm/s^2, but must be a number");
    EXPECT_EQ(complaint({"compliant-support", {{"stiffness", 3, "N/m"}}}),
              "effect 'compliant-support': stiffness is in 'N/m', but must be in 'N/mm'");
}

TEST(EffectMessages, NothingToActOn) {
    Model model = with_effects(make_chain(2), {compliant_support(1)});
    model.spheres[0].held = false;
    EXPECT_EQ(message_of([&] { equilibrium(model, {}); }),
              "none of the model's 3 spheres is held, so an effect of the support has nothing to act on: let a support "
              "hold one, or set its 'held' to true");
    EXPECT_EQ(message_of([] { StaticsSolver(make_chain(2), {std::make_shared<Slope>(1, 1)}); }),
              "the model has no skin, on which an effect acts: give it one, or take the effect away");
}

TEST(EffectsOfAMeasurement, AreNotPlayed) {
    for (const char* name : {"misalignment", "force-gain", "outliers"}) EXPECT_FALSE(is_body_effect(name));
    EXPECT_TRUE(is_body_effect("gravity"));
    const Model model = make_lattice({4, 2, 2});
    const Load load = force_at(model, 3, {1, 2, -3});
    EXPECT_EQ(equilibrium(with_effects(model, {{"force-gain", {{"gain", 2, ""}}}}), load).step,
              equilibrium(model, load).step);
}

}  // namespace
}  // namespace palpate::skeleton
