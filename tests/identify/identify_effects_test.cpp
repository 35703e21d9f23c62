#include <gtest/gtest.h>

#include "domains.h"
#include "identify/comparison/compare.h"
#include "identify/identify.h"
#include "identify/inference/domains/force/node_configuration.h"
#include "identify/inference/maximum/fit_map.h"
#include "lattice.h"
#include "mesh/errors.h"
#include "tests/messages.h"
#include "tests/skeleton/test_effects.h"

// Models that carry effects: played, identified and compared.

namespace palpate::identify {
namespace {

using skeleton::EquilibriumLaw;

const skeleton::EffectRecord heavy{"gravity", {{"gx", 0, "mm/s^2"}, {"gy", 0, "mm/s^2"}, {"gz", -4e5, "mm/s^2"}}};
const skeleton::EffectRecord soft_support{"compliant-support", {{"stiffness", 6, "N/mm"}}};

skeleton::Model with(skeleton::Model model, std::vector<skeleton::EffectRecord> effects,
                     EquilibriumLaw law = EquilibriumLaw::large_rotation) {
    model.effects = std::move(effects);
    model.law = law;
    return model;
}

skeleton::Model make_truth(std::vector<skeleton::EffectRecord> effects,
                           EquilibriumLaw law = EquilibriumLaw::large_rotation) {
    return with(with_truth(make_lattice({4, 2, 2}), {1.2}, {400}), std::move(effects), law);
}

/// The same with the stiffness that is not known.
skeleton::Model make_start(std::vector<skeleton::EffectRecord> effects,
                           EquilibriumLaw law = EquilibriumLaw::large_rotation) {
    return with(make_lattice({4, 2, 2}), std::move(effects), law);
}

MeasurementSet twin_of(const skeleton::Model& truth, double noise = 0) {
    std::vector<LoadState> states = push_spheres(truth, six_forces(1, 5));
    states.insert(states.begin(), LoadState{});  // and one that nothing pushes
    return simulate_measurements(truth, states, markers_on_spheres(truth), noise, 2);
}

IdentifyOptions quick() {
    IdentifyOptions options;
    options.scope = Scope::uniform;
    options.particles = 50;
    return options;
}

class WithEffect : public testing::TestWithParam<std::vector<skeleton::EffectRecord>> {};

TEST_P(WithEffect, StiffnessIsRecoveredAndWithoutItIsNot) {
    const skeleton::Model truth = make_truth(GetParam());
    const MeasurementSet set = twin_of(truth);
    const IdentifyResult result = identify(make_start(GetParam()), set, quick());
    // the model error never falls below 1e-4, and torsion moves the markers little
    EXPECT_NEAR(result.model.links[0].stiffness[0], 1.2, 1e-3);
    EXPECT_NEAR(result.model.links[0].stiffness[1], 400, 0.4);
    EXPECT_EQ(result.model.law, EquilibriumLaw::large_rotation);
    EXPECT_EQ(result.model.effects.size(), GetParam().size());
    EXPECT_LT(compare(result.model, set).relative, 1e-3);

    const IdentifyResult without = identify(make_start({}), set, quick());
    EXPECT_GT(std::abs(std::log(without.model.links[0].stiffness[0] / 1.2)), 0.05);
    EXPECT_GT(compare(without.model, set).relative, 0.05);
}

TEST_P(WithEffect, TheTruthLeavesNoiseOnly) {
    const skeleton::Model truth = make_truth(GetParam());
    const MeasurementSet set = twin_of(truth, 0.05);
    EXPECT_TRUE(compare(truth, set).adequate);
    EXPECT_FALSE(compare(with(truth, {}), set).adequate);
}

TEST_P(WithEffect, DerivativesMatchFiniteDifferences) {
    for (const EquilibriumLaw law : {EquilibriumLaw::linear, EquilibriumLaw::large_rotation}) {
        for (const Scope scope : {Scope::uniform, Scope::links}) {
            const MeasurementSet set = twin_of(make_truth(GetParam(), law), 0.05);
            const PositionDomain domain = make_domain(make_start(GetParam(), law), scope, set);
            const Eigen::VectorXd theta = 0.1 * Eigen::VectorXd::LinSpaced(domain.parameters().size(), -1, 1);
            const Eigen::VectorXd g = domain.jacobian(theta, domain.predict(theta, 1)).gradient();
            for (Eigen::Index p = 0; p < theta.size(); p += 5) {
                constexpr double h = 1e-5;
                const Eigen::VectorXd step = h * Eigen::VectorXd::Unit(theta.size(), p);
                const double difference = (domain.chi_squared(domain.predict(theta + step, 1)) -
                                           domain.chi_squared(domain.predict(theta - step, 1))) /
                                          (4 * h);
                // differences of step 1e-5 carry about seven digits
                EXPECT_NEAR(g[p], difference, 1e-5 * g.norm());
            }
        }
    }
}

TEST_P(WithEffect, TheLinearStandInAgreesWhereItWasMade) {
    const MeasurementSet set = twin_of(make_truth(GetParam()));
    const PositionDomain domain = make_domain(make_start(GetParam()), Scope::uniform, set);
    const Eigen::VectorXd theta = Eigen::VectorXd::Constant(domain.parameters().size(), 0.1);
    const Prediction prediction = domain.predict(theta, 1);
    const Prediction stand_in = domain.linearised(theta, prediction).predict(theta, 1);
    for (std::size_t s = 0; s < prediction.markers.size(); ++s) {
        EXPECT_LT((prediction.markers[s] - stand_in.markers[s]).norm(), 1e-10);  // rounding of positions
    }
}

INSTANTIATE_TEST_SUITE_P(Effects, WithEffect,
                         testing::Values(std::vector{heavy}, std::vector{soft_support},
                                         std::vector{soft_support, heavy}));

TEST(UnloadedStates, TellStiffnessUnderTheWeightOfTheModel) {
    const MeasurementSet set = twin_of(make_truth({heavy}));
    const auto tells = [&](const std::vector<skeleton::EffectRecord>& effects) {
        return collect_readings(make_start(effects), set)[0].informs_stiffness;
    };
    EXPECT_TRUE(tells({heavy}));
    EXPECT_TRUE(tells({soft_support, heavy}));
    EXPECT_FALSE(tells({}));
    EXPECT_FALSE(tells({soft_support}));
    EXPECT_FALSE(tells({{"outliers", {}}}));
}

TEST(UnloadedStates, AreEnoughToIdentifyABodyThatSags) {
    const skeleton::Model truth = make_truth({heavy});
    MeasurementSet set = twin_of(truth);
    set.states.resize(1);
    const IdentifyResult result = identify(make_start({heavy}), set, quick());
    EXPECT_LT(compare(result.model, set).relative, 1e-3);
    EXPECT_EQ(
        message_of([&] { identify(make_start({}), set, quick()); }).rfind("measurement set 'lattice' has no state", 0),
        0u);
}

TEST(CommonFactor, IsExactByTheLinearLawUnderWeight) {
    skeleton::Model model = make_truth({heavy}, EquilibriumLaw::linear);
    const MeasurementSet set = twin_of(model);
    for (skeleton::Link& link : model.links) link.stiffness /= 250;
    const PositionDomain domain = make_domain(model, Scope::zones, set);
    EXPECT_NEAR(domain.common_factor(Eigen::VectorXd::Zero(domain.parameters().size())), std::log(250), 1e-9);
}

TEST(CommonFactor, IsNotSoughtWhereTheSupportGivesWay) {
    const skeleton::Model model = make_truth({soft_support}, EquilibriumLaw::linear);
    const PositionDomain domain = make_domain(model, Scope::uniform, twin_of(model));
    EXPECT_EQ(domain.common_factor(Eigen::VectorXd::Constant(3, 2.0)), 0);
}

TEST(ForceDomain, BalancesTheWeightOfTheModel) {
    const skeleton::Model truth = make_truth({heavy}), start = make_start({heavy});
    const auto measured = measured_configurations(start, twin_of(truth));
    EXPECT_EQ(measured.size(), 7u);  // the unloaded one too
    const Parameters parameters = group_stiffness(start, Scope::uniform);
    const ForceDomain domain = force_domain(start, parameters, measured);
    const Eigen::VectorXd m = solve_force_domain(domain.forces + domain.torques);
    // rigid fits of markers carry ten digits
    EXPECT_NEAR(m[0], 1.2 / 2, 1e-6);
    EXPECT_NEAR(m[1], 400.0 / 750, 1e-6);
}

TEST(Burion2008, RefusesSupportsThatGiveWay) {
    const MeasurementSet set = twin_of(make_truth({soft_support}));
    IdentifyOptions options = quick();
    options.method = Method::burion2008;
    EXPECT_EQ(message_of([&] {
                  identify(make_start({heavy, soft_support}), set, options);
              }),
              "method burion2008 takes held spheres to stay where they are, but the model's effect 'compliant-support' "
              "lets them move: take it out of the model, or use method tempered");
}

TEST(KnownPressure, OfAnInflatedBodyTellsItsStiffness) {
    const auto inflated = [](skeleton::Model model) {
        return skeleton::testing::with_cavity(std::move(model), {60, 20, 20}, 15);
    };
    const skeleton::Model truth = inflated(with_truth(make_lattice({4, 2, 2}), {1.2}, {400}));
    std::vector<LoadState> states(3);
    for (int s = 0; s < 3; ++s) {
        states[s].probe = s;
        states[s].pressure = 0.02 * s;
    }
    MeasurementSet set = simulate_measurements(truth, states, markers_on_spheres(truth), 0, 2);
    IdentifyOptions options = quick();
    options.particles = 10;
    options.law = LawChoice::large_rotation;
    EXPECT_GT(compare(inflated(make_lattice({4, 2, 2})), set).rms, 0.05);
    const IdentifyResult result = identify(inflated(make_lattice({4, 2, 2})), set, options);
    EXPECT_NEAR(result.model.links[0].stiffness[0], 1.2, 1e-2);
    EXPECT_LT(compare(result.model, set).relative, 1e-3);

    for (LoadState& state : set.states) state.pressure = missing;
    EXPECT_NE(message_of([&] { identify(inflated(make_lattice({4, 2, 2})), set, quick()); }), "");
}

}  // namespace
}  // namespace palpate::identify
