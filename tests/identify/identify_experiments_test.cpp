// The two experiments of [Burion 2008, section IV], rebuilt: same lattices, same numbers of particles and measurements,
// and the paper's own final errors as bounds.

#include <gtest/gtest.h>

#include "identify/identify.h"
#include "lattice.h"

namespace palpate::identify {
namespace {

/// V holds kE in [0.1, 4] N/mm and kF in [37.5, 1500] N mm/rad; torsion is known, as the paper identifies kE and kF.
IdentifyOptions paper_options(int particles, std::uint64_t seed) {
    IdentifyOptions options;
    options.method = Method::burion2008;
    options.particles = particles;
    options.search_low = 0.05;
    options.search_high = 2;
    options.fixed = {skeleton::Stiffness::torsion};
    options.seed = seed;
    return options;
}

double relative_error(double value, double truth) { return std::abs(value / truth - 1); }

TEST(Burion2008, ExperimentOneFindsTheCubesStiffnessAsWellAsThePaper) {
    const skeleton::Model model = make_lattice({3, 3, 2});
    const MeasurementSet set = simulate_measurements(with_truth(model, {1.3}, {430}),
                                                     push_spheres(model, six_forces(6, 6)), markers_on_spheres(model));
    for (const std::uint64_t seed : {1, 2, 3, 4, 5}) {
        IdentifyOptions options = paper_options(600, seed);
        options.scope = Scope::uniform;
        const IdentifyResult result = identify(model, set, options);
        ASSERT_EQ(result.posterior.size(), 2U);
        EXPECT_EQ(result.posterior[0].parameter, "elongation");
        EXPECT_EQ(result.posterior[1].parameter, "flexion");
        EXPECT_LE(relative_error(result.posterior[0].mean, 1.3), 0.008) << "seed " << seed;
        EXPECT_LE(relative_error(result.posterior[1].mean, 430), 0.006) << "seed " << seed;
        EXPECT_LE(relative_error(result.best[0], 1.3), 0.008) << "seed " << seed;
        EXPECT_EQ(result.history.size(), 20U);
    }
}

TEST(Burion2008, ExperimentTwoFindsThreeZonesOfASheetAsWellAsThePaper) {
    const skeleton::Model model = make_lattice({6, 3, 1}, 3);
    const std::vector<double> kE{0.9, 2.6, 1.5}, kF{300, 850, 520};
    const MeasurementSet set = simulate_measurements(
        with_truth(model, kE, kF), push_spheres(model, six_forces(0.5, 10)), markers_on_spheres(model));
    for (const std::uint64_t seed : {1, 2, 3, 4, 5}) {
        IdentifyOptions options = paper_options(900, seed);
        options.scope = Scope::zones;
        const IdentifyResult result = identify(model, set, options);
        ASSERT_EQ(result.posterior.size(), 6U);
        for (int zone = 0; zone < 3; ++zone) {
            EXPECT_LE(relative_error(result.posterior[2 * zone].mean, kE[zone]), 0.046) << "seed " << seed;
            EXPECT_LE(relative_error(result.posterior[2 * zone + 1].mean, kF[zone]), 0.101) << "seed " << seed;
        }
    }
}

TEST(Burion2008, SameSeedSameNumbers) {
    const skeleton::Model model = make_lattice({3, 2, 1});
    const MeasurementSet set = simulate_measurements(
        with_truth(model, {1.3}, {430}), push_spheres(model, {{0, 0, -1}, {4, 0, 0}}), markers_on_spheres(model));
    IdentifyOptions options = paper_options(50, 7);
    options.scope = Scope::uniform;
    EXPECT_EQ(identify(model, set, options).best, identify(model, set, options).best);
}

TEST(Tempered, FindsThreeZonesFromNoisyMarkersWhereForcesAreBlind) {
    // 0.2 mm of noise, 0.5 % of the spacing: net forces are then off by more than half the stiffness
    const skeleton::Model model = make_lattice({6, 3, 1}, 3);
    const std::vector<double> kE{0.9, 2.6, 1.5}, kF{300, 850, 520};
    const MeasurementSet set = simulate_measurements(
        with_truth(model, kE, kF), push_spheres(model, six_forces(0.5, 10)), markers_on_spheres(model), 0.2, 3);
    IdentifyOptions options;
    options.scope = Scope::zones;
    options.fixed = {skeleton::Stiffness::torsion};
    const IdentifyResult result = identify(model, set, options);
    ASSERT_EQ(result.posterior.size(), 6U);
    EXPECT_EQ(result.model.law, skeleton::EquilibriumLaw::large_rotation);
    for (int zone = 0; zone < 3; ++zone) {
        // four standard deviations of the posterior's own
        const PosteriorRow &elongation = result.posterior[2 * zone], &flexion = result.posterior[2 * zone + 1];
        EXPECT_NEAR(elongation.mean, kE[zone], 4 * elongation.sd);
        EXPECT_NEAR(flexion.mean, kF[zone], 4 * flexion.sd);
        EXPECT_TRUE(elongation.informed);
        EXPECT_LE(elongation.sd, 0.2 * kE[zone]);
    }
}

}  // namespace
}  // namespace palpate::identify
