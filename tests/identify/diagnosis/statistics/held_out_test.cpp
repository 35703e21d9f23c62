#include "identify/diagnosis/statistics/held_out.h"

#include <cmath>
#include <functional>

#include "identify/diagnosis/search/baselines.h"
#include "tests/identify/diagnosed.h"

// Predictions of what was not seen.

namespace palpate::identify {
namespace {

TEST_F(Diagnosed, LeavingProbesOutWhitensToOne) {
    double sum = 0;
    for (const std::uint64_t seed : {1, 2, 3, 4}) {
        DiagnoseOptions options;
        options.law = neo_hookean;
        options.screen = false;
        const Diagnosis found = diagnose(twin(truth(), sigma, seed), options);
        EXPECT_NEAR(found.baseline_held_out.rms_mm, sigma, 0.5 * sigma);  // in a twin contacts are as they are told
        sum += std::pow(found.baseline_held_out.whitened_rms, 2);
    }
    // 4 sigma of 4 x 648 rows, and 6 % that the nuisances' priors, wider than a twin needs, take
    EXPECT_NEAR(sum / 4, 0.97, 4 * std::sqrt(2 / (4 * 648.0)) + 0.03);
}

TEST(HeldOutGroups, AreProbesAndOfOneProbeItsLoads) {
    Problem problem;
    problem.probe = {1, 1, 2};
    problem.action = {0, 1, 1, 2};
    problem.measured.setZero(4);
    EXPECT_EQ(held_out_groups(problem), (std::vector<int>{1, 1, 1, 2}));
    problem.probe = {1, 1, -1};  // the last without load
    EXPECT_EQ(held_out_groups(problem), (std::vector<int>{0, 1, 1, 2}));
}

class HeldOutProbes : public Diagnosed {
protected:
    /// Errors on probes 3 and 7, of a fit to the others.
    HeldOut predicted(const Explanation& hidden, const std::vector<skeleton::EffectRecord>& known) const {
        MeasurementSet fitted = twin(hidden), unseen = fitted;
        const auto is_unseen = [](const LoadState& state) { return state.probe == 3 || state.probe == 7; };
        std::erase_if(fitted.states, is_unseen);
        std::erase_if(unseen.states, std::not_fn(is_unseen));
        DiagnoseOptions options;
        options.law = neo_hookean;
        options.screen = false;
        options.known = known;
        return predict(*model_, make_problem(unseen, sigma), diagnose(fitted, options).best(), options.refit);
    }
};

TEST_F(HeldOutProbes, OfANullArePredictedToTheNoise) {
    const HeldOut found = predicted(truth(), {});
    EXPECT_NEAR(found.whitened_rms, 1, 4 / std::sqrt(2 * 144.0));  // 4 sigma of 144 rows
    EXPECT_LT(found.rms_mm, 0.1);                                  // contacts unknown, of displacements of some 1 mm
    EXPECT_EQ(found.residual.size(), 144);
}

TEST_F(HeldOutProbes, ArePredictedOnceTheEffectIsIn) {
    const Explanation hidden = truth("gravity", half_g);
    const HeldOut without = predicted(hidden, {}), with_gravity = predicted(hidden, {{"gravity", {}}});
    EXPECT_GT(without.whitened_rms, 2);
    EXPECT_NEAR(with_gravity.whitened_rms, 1, 4 / std::sqrt(2 * 144.0));  // 4 sigma
    EXPECT_LT(with_gravity.rms_mm, 0.2 * without.rms_mm);
}

TEST_F(HeldOutProbes, HaveGainsThatNobodyKnows) {
    // The sensor's gain at a probe that was not fitted counts as unknown: its error is large, and expected.
    const Explanation hidden = truth("force-gain", numbers({0.1, -0.1, 0.45, -0.1, 0.1, 0.1, -0.45, -0.1}));
    const HeldOut unknown = predicted(hidden, {{"force-gain", {}}}), taken_as_one = predicted(hidden, {});
    EXPECT_GT(unknown.rms_mm, 3 * sigma);
    EXPECT_LT(unknown.whitened_rms, 1.5);  // gains of 1.5 prior sd, linearised
    EXPECT_GT(taken_as_one.whitened_rms, 1.5 * unknown.whitened_rms);
}

TEST_F(HeldOutProbes, ThatTheBodyDoesNotBearArePlayedAsFarAsItDoes) {
    // A fit that knows of no stiffening is too soft for a press that it has not seen.
    const Problem fitted = make_problem(twin(truth()), sigma);
    const Refit fit = refit(*model_, fitted, first_guess(*model_, fitted, neo_hookean, 1), {});
    const auto pressed = [&](double force) {
        LoadState state{.probe = 9, .time = 1, .contacts = {{Vec3(40, 5, 5), Vec3(-force, 0, 0), 3}}};
        return make_problem(body_.set({state}), sigma);
    };
    ASSERT_THROW(solve_forward(*model_, pressed(400), fit.explanation, 1), SolverFailure);
    const HeldOut borne = predict(*model_, pressed(5), fit, {}), too_much = predict(*model_, pressed(400), fit, {});
    EXPECT_TRUE(std::isfinite(too_much.whitened_rms));
    EXPECT_GT(too_much.rms_mm, borne.rms_mm);  // the readings say that nothing moved
}

}  // namespace
}  // namespace palpate::identify
