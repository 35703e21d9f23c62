#include "identify/preflight/preflight.h"

#include <gmock/gmock.h>

#include "tests/identify/diagnosed.h"

namespace palpate::identify {
namespace {

using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;

/// A bar with its noise told, judged and diagnosed.
class Judged : public Diagnosed {
protected:
    MeasurementSet with_noise(MeasurementSet set, double noise = sigma) const {
        set.position_noise = noise;
        set.material = MaterialGuess{.young = SmallBody::young};
        return set;
    }
    Preflight judge(const MeasurementSet& set, bool experiments = false) const {
        return assess(*model_, set, {.diagnose = {}, .experiments = experiments});
    }
    /// The bar's own set, in small strain, with weight of so many g upwards and to the side.
    MeasurementSet heavy(double g) const {
        Explanation hidden = bare_truth(*model_, 0);
        hidden.effects = {find_effect("gravity")};
        hidden.values = {g * Vec3(0, 0.6, 0.8)};
        return with_noise(twin(hidden));
    }
};

TEST_F(Judged, WhatItTellsOfGravityHoldsInTheDiagnosis) {
    // The diagnosis names twice the least strength that the preflight told, and nothing at a fifth of it.
    const Preflight preflight = judge(heavy(0));
    const EffectProspect* gravity = preflight.prospect_of("gravity");
    ASSERT_NE(gravity, nullptr);
    ASSERT_TRUE(gravity->own.has_value());
    EXPECT_EQ(gravity->own->unit, "mm/s^2");
    EXPECT_EQ(gravity->share, 1);
    const double least = gravity->own->value / 9810;
    EXPECT_THAT(diagnose(heavy(2 * least)).explanation, Contains("gravity"));
    EXPECT_THAT(diagnose(heavy(0.2 * least)).explanation, IsEmpty());
}

TEST_F(Judged, StrengthsAreTheStrongerTheMoreNoiseThereIs) {
    const Preflight little = judge(with_noise(twin(bare_truth(*model_, 0)), sigma));
    const Preflight much = judge(with_noise(twin(bare_truth(*model_, 0)), 10 * sigma));
    // Ten times the noise, but what is doubtful beside it, such as places of contacts, stays: 7 times at least.
    for (const char* name : {"gravity", "misalignment"})
        EXPECT_GT(much.prospect_of(name)->least, 5.7 * little.prospect_of(name)->least) << name;
}

TEST_F(Judged, WhatCannotShowSaysWhy) {
    const Preflight preflight = judge(with_noise(twin(bare_truth(*model_, 0))));
    EXPECT_THAT(preflight.prospect_of("pressure")->why_not, HasSubstr("no closed cavity"));
    EXPECT_THAT(preflight.prospect_of("viscosity")->why_not, HasSubstr("two times"));
    EXPECT_THAT(preflight.prospect_of("plasticity")->why_not, HasSubstr("follows a load"));
    EXPECT_THAT(preflight.prospect_of("damage")->why_not,
                HasSubstr("no body bears less, or something else, after more"));
    EXPECT_THAT(preflight.prospect_of("torsion")->why_not, HasSubstr("skeleton"));
    EXPECT_THAT(preflight.prospect_of("slip")->why_not, HasSubstr("no tool"));
    EXPECT_THAT(preflight.prospect_of("volume")->why_not, HasSubstr("Poisson's ratio"));
    for (const EffectProspect& one : preflight.effects) {
        if (one.why_not.empty()) continue;
        EXPECT_EQ(one.share, 0) << one.effect->name();
    }
}

TEST_F(Judged, NumbersAreToldAsWellAsTheFitTellsThem) {
    const Preflight preflight = judge(with_noise(twin(bare_truth(*model_, 0))));
    const ParameterProspect& young = preflight.parameters.material.front();
    EXPECT_EQ(young.name, "young");
    EXPECT_TRUE(young.informed());
    DiagnoseOptions alone;
    alone.screen = false;
    const Diagnosis fitted = diagnose(with_noise(twin(bare_truth(*model_, 0))), alone);
    const double sd = std::sqrt(fitted.baseline.covariance(0, 0));
    EXPECT_NEAR(young.sd, sd, 0.012 * sd);  // where the fit stands is not where the guess does: 0.8 %
}

TEST_F(Judged, MoreStatesNeverAskForMore) {
    const Preflight preflight = judge(with_noise(twin(bare_truth(*model_, 0))), true);
    ASSERT_FALSE(preflight.experiments.empty());
    for (const ExperimentProspect& one : preflight.experiments) {
        EXPECT_FALSE(one.experiment.words.empty());
        EXPECT_FALSE(one.gains.empty());
        for (const ExperimentGain& gain : one.gains)
            EXPECT_TRUE(gain.least_after < gain.least_before || gain.share_after > gain.share_before);
    }
}

TEST_F(Judged, AnUnloadedPoseIsAskedForWhereThereIsNone) {
    MeasurementSet set = with_noise(twin(bare_truth(*model_, 0)));
    const auto kinds = [&] {
        std::vector<std::string> all;
        for (const Experiment& one : possible_experiments(*model_, set, make_problem(set, sigma)))
            all.push_back(one.kind);
        return all;
    };
    EXPECT_THAT(kinds(), testing::Not(Contains("unload")));
    std::erase_if(set.states, [](const LoadState& state) { return state.contacts.empty(); });
    EXPECT_THAT(kinds(), Contains("unload"));
    EXPECT_THAT(kinds(), Contains("levels"));
    EXPECT_THAT(kinds(), testing::Not(Contains("pressure")));
}

TEST_F(Judged, ProbesOfExperimentsAreNew) {
    const MeasurementSet set = with_noise(twin(bare_truth(*model_, 0)));
    for (const Experiment& one : possible_experiments(*model_, set, make_problem(set, sigma))) {
        EXPECT_EQ(one.states.size(), one.conditions.size());
        for (const LoadState& state : one.states) EXPECT_GT(state.probe, 8) << one.kind;
    }
}

TEST_F(Judged, NoiseThatIsNotToldIsAHundredthOfTheMotion) {
    MeasurementSet set = twin(bare_truth(*model_, 0));
    set.position_noise.reset();
    for (LoadState& state : set.states)
        for (Reading& reading : state.readings) reading.sigma = missing;
    const Preflight preflight = judge(set);
    EXPECT_FALSE(preflight.noise_known);
    EXPECT_NEAR(preflight.noise_mm, 0.01 * preflight.moved_mm, 1e-15);  // rounding
}

TEST_F(Judged, ExchangedMarkersAreTold) {
    MeasurementSet set = with_noise(twin(bare_truth(*model_, 0)));
    std::swap(set.states[3].readings[2].position, set.states[3].readings[17].position);
    const Preflight preflight = judge(set);
    ASSERT_FALSE(preflight.suspicions.empty());
    EXPECT_EQ(preflight.suspicions.front().kind, Suspect::exchanged);
    EXPECT_EQ(preflight.suspicions.front().state, 3);
}

}  // namespace
}  // namespace palpate::identify
