#include "identify/inference/maximum/modes.h"

#include <gtest/gtest.h>

#include "identify/identify.h"
#include "identify/inference/maximum/modes.h"
#include "tests/identify/domains.h"
#include "tests/identify/lattice.h"

namespace palpate::identify {
namespace {

/// Two links in line, held at both ends, pushed along and across in the middle, which is read along the push alone:
/// the answer is the same with the links exchanged. The push along is too small to buckle them.
struct TwoStrings {
    skeleton::Model model = with_law(make_lattice({3, 1, 1}, 2), skeleton::EquilibriumLaw::large_rotation);
    MeasurementSet set;

    TwoStrings() {
        model.spheres.back().held = true;
        for (skeleton::Link& link : model.links) link.stiffness = Vec3(2, 10, 10);
        std::vector<LoadState> states;
        for (const Vec3& force : {Vec3(1, 0, 0), Vec3(-1, 0, 0), Vec3(0, 0, 0.05), Vec3(0, 0, -0.05)}) {
            states.push_back({.probe = static_cast<int>(states.size()) + 1, .contacts = {{Vec3(40, 0, 0), force, 0}}});
        }
        set = simulate_measurements(with_truth(model, {1, 3}, {10, 10}), states, {{1, Vec3(40, 0, 0), {}}}, 0.005, 3);
        for (LoadState& state : set.states) {
            Vec3& position = state.readings[0].position;
            position = (state.contacts[0].force.array() == 0).select(missing, position);
        }
    }
    PositionDomain domain() const {
        const std::vector<skeleton::Stiffness> known{skeleton::Stiffness::flexion, skeleton::Stiffness::torsion};
        PositionDomain result(model, model.law, group_stiffness(model, Scope::zones, known),
                              collect_readings(model, set), 1);
        result.set_model_error(1e-4);
        return result;
    }
};

TEST(Modes, AFitFallsIntoOneOfTwoEqualOnesAndBothAreFound) {
    const TwoStrings strings;
    const PositionDomain domain = strings.domain();
    const LogNormalPrior prior{Eigen::VectorXd::Zero(2), Eigen::VectorXd::Constant(2, 3), nullptr};
    const FitResult one = fit_map(domain, prior, Eigen::Vector2d(-0.5, 0.2), 1),
                    other = fit_map(domain, prior, Eigen::Vector2d(0.2, -0.5), 1);
    // 1 and 3 N/mm of 2; the noise of 2 % along leaves some per cent open
    EXPECT_NEAR(one.theta[0], std::log(0.5), 0.15);
    EXPECT_NEAR(one.theta[1], std::log(1.5), 0.1);
    EXPECT_NEAR(other.theta[0], one.theta[1], 1e-3);  // the fit's tolerance
    EXPECT_NEAR(other.theta[1], one.theta[0], 1e-3);

    // from either, and from the saddle between them
    for (const Eigen::Vector2d& start :
         {Eigen::Vector2d(-0.5, 0.2), Eigen::Vector2d(0.2, -0.5), Eigen::Vector2d(0, 0)}) {
        int evaluations = 0;
        const auto modes = find_modes(domain, prior, fit_map(domain, prior, start, 1), 1, 1, evaluations);
        ASSERT_EQ(modes.size(), 2U);
        EXPECT_NEAR(modes[0].theta.sum(), one.theta.sum(), 1e-3);
        EXPECT_NEAR(modes[0].theta[0], modes[1].theta[1], 1e-3);
        EXPECT_GT(evaluations, 8);
    }
}

TEST(Modes, AnIdentificationKeepsBothWithEqualWeight) {
    const TwoStrings strings;
    IdentifyOptions options;
    options.scope = Scope::zones;
    options.law = LawChoice::large_rotation;
    options.fixed = {skeleton::Stiffness::flexion, skeleton::Stiffness::torsion};
    options.particles = 1000;
    for (const std::uint64_t seed : {1, 2, 3}) {
        options.seed = seed;
        const IdentifyResult result = identify(strings.model, strings.set, options);
        ASSERT_EQ(result.modes.size(), 2U);
        // five sigma of 1000 particles of which half count
        EXPECT_NEAR(result.modes[0].probability, 0.5, 5 * 0.5 / std::sqrt(500));
        EXPECT_NEAR(result.modes[0].probability + result.modes[1].probability, 1, 1e-9);
        EXPECT_NEAR(result.modes[0].stiffness[0], result.modes[1].stiffness[1], 1e-2);
        EXPECT_GT(result.posterior[0].sd, 0.9);  // of 1 and 3 in equal parts: 1
        ASSERT_FALSE(result.correlations.empty());
        EXPECT_LT(result.correlations[0].value, -0.9);  // where one is soft the other is stiff
    }
}

TEST(Modes, ABodyThatIsToldHasOne) {
    const skeleton::Model model = make_lattice({6, 3, 1}, 3);
    const MeasurementSet set =
        simulate_measurements(with_truth(model, {0.9, 2.6, 1.5}, {300, 850, 520}),
                              push_spheres(model, six_forces(0.5, 10)), markers_on_spheres(model), 0.1);
    IdentifyOptions options;
    options.scope = Scope::zones;
    EXPECT_EQ(identify(model, set, options).modes.size(), 1U);
}

}  // namespace
}  // namespace palpate::identify
