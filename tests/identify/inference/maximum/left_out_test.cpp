#include "identify/inference/maximum/left_out.h"

#include <gtest/gtest.h>

#include <numeric>

#include "tests/identify/lattice.h"

namespace palpate::identify {
namespace {

using skeleton::EquilibriumLaw;

/// A plate whose three zones differ, fitted with one number a kind: no stiffness follows it everywhere.
struct ForecastOfALeftOutProbe : testing::TestWithParam<EquilibriumLaw> {
    const skeleton::Model model = with_law(make_lattice({4, 3, 1}, 3), GetParam());
    const MeasurementSet set =
        simulate_measurements(with_truth(model, {1.4, 2.0, 2.8}, {600, 750, 900}),
                              push_spheres(model, six_forces(0.3, 5)), markers_on_spheres(model));

    PositionDomain domain_of(const MeasurementSet& some) const {
        PositionDomain domain(model, GetParam(), group_stiffness(model, Scope::uniform), collect_readings(model, some),
                              1);
        domain.set_model_error(0.05);
        return domain;
    }
    static FitResult fit(const PositionDomain& domain) {
        return fit_map(domain, prior(domain), Eigen::VectorXd::Zero(domain.parameters().size()), 1);
    }
    static LogNormalPrior prior(const PositionDomain& domain) {
        const int P = domain.parameters().size();
        return {Eigen::VectorXd::Zero(P), Eigen::VectorXd::Constant(P, wide_sd), nullptr};
    }
    /// Squared relative error of a state at theta.
    static double squared_error(const PositionDomain& domain, const Eigen::VectorXd& theta, int s) {
        const StateReadings& state = domain.states()[s];
        const double error = rms(state.measured - domain.predict(theta, 1).markers[s]);
        return error * error / domain.squared_scale(s);
    }
};

TEST_P(ForecastOfALeftOutProbe, IsThatOfAFitWithoutIt) {
    const PositionDomain domain = domain_of(set);
    const FitResult whole = fit(domain);
    std::vector<int> probes(domain.states().size());
    std::iota(probes.begin(), probes.end(), 1);
    const ForecastError estimate = leave_one_out_error(domain, prior(domain), whole, probes);

    double fitted = 0, left_out = 0;
    for (int s = 0; s < static_cast<int>(probes.size()); ++s) {
        MeasurementSet others = set;
        others.states.erase(others.states.begin() + domain.states()[s].state);
        fitted += squared_error(domain, whole.theta, s);
        left_out += squared_error(domain, fit(domain_of(others)).theta, s);
    }
    const auto count = static_cast<double>(probes.size());
    // markers go not quite linearly with the logarithms of stiffness, which differ by a tenth between these fits
    EXPECT_NEAR(estimate.relative, std::sqrt(left_out / count), 0.1 * estimate.relative);
    EXPECT_GT(estimate.relative, 1.1 * std::sqrt(fitted / count)) << "a fit is nearest where it was fitted";
    EXPECT_EQ(estimate.probes, 6);
}

TEST_P(ForecastOfALeftOutProbe, NeedsNoFitThatHasSettled) {
    const PositionDomain domain = domain_of(set);
    FitResult whole = fit(domain);
    const std::vector<int> probes{1, 2, 3, 4, 5, 6};
    const double settled = leave_one_out_error(domain, prior(domain), whole, probes).relative;
    whole.theta.array() += 0.02;
    whole.prediction = domain.predict(whole.theta, 1);
    EXPECT_NEAR(leave_one_out_error(domain, prior(domain), whole, probes).relative, settled, 0.01 * settled);
}

TEST_P(ForecastOfALeftOutProbe, TakesThreeProbes) {
    const PositionDomain domain = domain_of(set);
    // times of one probe are left out together
    EXPECT_TRUE(std::isnan(leave_one_out_error(domain, prior(domain), fit(domain), {1, 1, 1, 2, 2, 2}).relative));
    EXPECT_FALSE(std::isnan(leave_one_out_error(domain, prior(domain), fit(domain), {1, 1, 2, 2, 3, 3}).relative));
}

INSTANTIATE_TEST_SUITE_P(LeftOutErrors, ForecastOfALeftOutProbe,
                         testing::Values(EquilibriumLaw::linear, EquilibriumLaw::large_rotation));

}  // namespace
}  // namespace palpate::identify
