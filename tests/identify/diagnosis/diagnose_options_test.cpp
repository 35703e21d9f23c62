#include "identify/diagnosis/diagnose.h"

#include <functional>

#include "tests/identify/diagnosed.h"
#include "tests/messages.h"

// What a diagnosis is told, what it is not, and what it refuses.

namespace palpate::identify {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;

class WithACrushingProbe : public Diagnosed {
protected:
    /// A ninth probe between the first and the second, which presses the bar lengthwise with a hundred times its
    /// modulus, and reads what a linear body would show.
    WithACrushingProbe() {
        set_ = twin(truth());
        std::vector<LoadState> crushing{
            LoadState{.probe = 9, .time = 1, .contacts = {{Vec3(40, 5, 5), Vec3(-1000, 0, 0), 3}}}};
        set_.states.insert(set_.states.begin() + 2,
                           make_twin(*model_, body_.set(crushing), truth(0), sigma).states.front());
    }
    MeasurementSet set_;
};

TEST_F(WithACrushingProbe, ItIsLeftOut) {
    const Diagnosis found = diagnose(set_);
    EXPECT_THAT(found.notes, Contains(HasSubstr("Probe 9 presses")));
    EXPECT_EQ(found.problem.readings(), 216);
    EXPECT_THAT(found.problem.probe, testing::Not(Contains(9)));
    EXPECT_EQ(found.verdict, Verdict::adequate);
}

TEST_F(WithACrushingProbe, OutliersAreNumberedAsTheSetsReadings) {
    set_.states[4].readings[5].position += 20 * sigma * Vec3(1, -1, 1);
    EXPECT_THAT(diagnose(set_).outliers.readings, ElementsAre(4 * 24 + 5));
}

TEST(DiagnoseOptions, TheLeastEvidenceFollowsFromTheRateOfFalseClaims) {
    DiagnoseOptions options;
    const auto effects = static_cast<double>(catalogue().size());
    EXPECT_DOUBLE_EQ(options.least_evidence(), std::log(effects / 1e-3));
    options.false_claims = 1e-6;
    options.without = {"gravity"};
    EXPECT_DOUBLE_EQ(options.least_evidence(), std::log((effects - 1) / 1e-6));
    options.false_claims = 0;
    EXPECT_THAT(message_of<InvalidInput>([&] { options.validate(); }), HasSubstr("false_claims is 0"));
}

TEST_F(Diagnosed, UnknownNoiseIsEstimated) {
    for (const std::uint64_t seed : {1, 2, 3, 4}) {
        MeasurementSet set = twin(truth(), sigma, seed);
        set.position_noise.reset();
        const Diagnosis found = diagnose(set);
        EXPECT_FALSE(found.noise_known);
        EXPECT_NEAR(found.noise / sigma, 1, 0.15) << seed;  // four sigma of a median of 216
        EXPECT_EQ(found.verdict, Verdict::adequate);
        EXPECT_THAT(found.notes, Contains(HasSubstr("does not tell its noise")));
    }
}

TEST_F(Diagnosed, UnknownNoiseIsEstimatedNextToAMissingEffect) {
    for (const std::uint64_t seed : {1, 2}) {
        MeasurementSet set = twin(truth("gravity", half_g), sigma, seed);
        set.position_noise.reset();
        const Diagnosis found = diagnose(set);
        EXPECT_THAT(found.explanation, ElementsAre("gravity"));
        EXPECT_NEAR(found.noise / sigma, 1, 0.15) << seed;  // as above
    }
}

TEST_F(Diagnosed, ASigmaThatAReadingTellsStays) {
    MeasurementSet set = twin(truth());
    set.position_noise.reset();
    for (LoadState& state : set.states) {
        for (std::size_t r = 0; r < 12; ++r) state.readings[r].sigma = sigma;
    }
    const Diagnosis found = diagnose(set);
    for (Eigen::Index n = 0; n < found.problem.rows(); ++n) {
        if (found.problem.coordinate[n] / 3 >= 12) continue;
        ASSERT_EQ(found.problem.sigma[n], sigma) << n;
    }
}

TEST_F(Diagnosed, EffectsThatAreKnownAreInEveryExplanation) {
    DiagnoseOptions options;
    options.known = {{"gravity", {{"gz", -3000, "mm/s^2"}}}};
    const Diagnosis found = diagnose(twin(truth("gravity", half_g)), options);
    EXPECT_EQ(found.verdict, Verdict::adequate);
    ASSERT_EQ(found.baseline.explanation.effects.size(), 1u);
    EXPECT_NEAR(found.baseline.explanation.values[0][2], half_g.z(), 0.03);  // fitted anew, 4 sd
    for (const Candidate& c : found.ranking) EXPECT_NE(c.effect->name(), "gravity");
}

TEST_F(Diagnosed, WithoutTheScreenOnlyTheBaselineIsFitted) {
    DiagnoseOptions options;
    options.screen = false;
    const Diagnosis found = diagnose(twin(truth("gravity", half_g)), options);
    EXPECT_EQ(found.verdict, Verdict::unexplained);
    for (const Candidate& c : found.ranking) EXPECT_FALSE(c.refit);
}

TEST(MostLeft, IsWhatNoiseIsToldToOrWhatChanceLeaves) {
    DiagnoseOptions options;
    EXPECT_DOUBLE_EQ(options.most_left(10000), 1.1);
    EXPECT_NEAR(options.most_left(60), std::sqrt(99.607 / 60), 1e-4);  // chi^2 of 60 that 0.001 exceed
    options.noise_accuracy = 0.5;
    EXPECT_DOUBLE_EQ(options.most_left(60), 1.5);
}

TEST_F(Diagnosed, NumbersDoNotDependOnThreads) {
    const MeasurementSet set = twin(truth("gravity", half_g));
    DiagnoseOptions one, two;
    two.refit.threads = 2;
    const Diagnosis a = diagnose(set, one), b = diagnose(set, two);
    EXPECT_EQ(a.baseline.log_evidence, b.baseline.log_evidence);
    EXPECT_EQ(a.law_evidence, b.law_evidence);
    ASSERT_EQ(a.ranking.size(), b.ranking.size());
    for (std::size_t c = 0; c < a.ranking.size(); ++c) {
        EXPECT_EQ(a.ranking[c].effect->name(), b.ranking[c].effect->name());
        EXPECT_EQ(a.ranking[c].screened, b.ranking[c].screened);
        EXPECT_EQ(a.ranking[c].log_bayes_factor, b.ranking[c].log_bayes_factor);
        EXPECT_EQ(a.ranking[c].estimate.sd, b.ranking[c].estimate.sd);
    }
    EXPECT_EQ(a.best().explanation.all(), b.best().explanation.all());
    EXPECT_EQ(a.best().residual, b.best().residual);
}

TEST_F(Diagnosed, TakesProbesThatReadOneCoordinateOnly) {
    MeasurementSet set = twin(truth("gravity", half_g));
    for (LoadState& state : set.states) {
        for (Reading& reading : state.readings) reading.position.head<2>().setConstant(missing);
    }
    const Diagnosis found = diagnose(set);
    EXPECT_THAT(found.explanation, Contains("gravity"));
    EXPECT_EQ(found.problem.rows(), 216);
}

TEST_F(Diagnosed, MessagesNameOptionValueAndBound) {
    const auto message = [&](const std::function<void(DiagnoseOptions&)>& change) {
        DiagnoseOptions options;
        change(options);
        return message_of([&] { options.validate(); });
    };
    EXPECT_EQ(message([](DiagnoseOptions& o) { o.refits = 0; }), "refits is 0; allowed: 1 and more");
    EXPECT_EQ(message([](DiagnoseOptions& o) { o.most_pull = 0; }), "most_pull is 0; it must be above 0");
    EXPECT_EQ(message([](DiagnoseOptions& o) { o.false_refusals = 0; }),
              "false_refusals is 0; allowed: above 0 and below 1");
    EXPECT_THAT(message([](DiagnoseOptions& o) { o.noise_accuracy = missing; }), HasSubstr("noise_accuracy is nan"));
    EXPECT_EQ(message([](DiagnoseOptions& o) { o.mesh_error = -1; }), "mesh_error is -1; it must be 0 or more");
    EXPECT_THAT(message([](DiagnoseOptions& o) { o.without = {"gravty"}; }),
                HasSubstr("effect 'gravty' is not known (did you mean 'gravity'?)"));
    EXPECT_THAT(message([](DiagnoseOptions& o) { o.refit.steps = 0; }), HasSubstr("steps is 0"));
    EXPECT_EQ(message([](DiagnoseOptions&) {}), "");
}

TEST_F(Diagnosed, AKnownEffectThatIsNoneIsRefused) {
    DiagnoseOptions options;
    options.known = {{"gravty", {}}};
    EXPECT_THAT(message_of([&] { diagnose(twin(truth()), options); }), HasSubstr("did you mean 'gravity'?"));
}

TEST_F(Diagnosed, ALawThatTheModelLacksIsRefused) {
    DiagnoseOptions options;
    options.law = 7;
    EXPECT_THAT(message_of([&] { diagnose(twin(truth()), options); }), HasSubstr("law is 7"));
}

TEST_F(Diagnosed, ASetWithoutLabelledReadingsIsRefused) {
    MeasurementSet set = twin(truth());
    for (LoadState& state : set.states) state.readings.clear();
    EXPECT_THAT(message_of([&] { diagnose(set); }), HasSubstr("has no labelled reading"));
}

TEST_F(Diagnosed, LoadsThatNoBodyBearsAreAFailureThatIsSaid) {
    // Loads of another unit, a million times too large: a body that stiff is beyond what is believed.
    MeasurementSet set = twin(truth());
    for (LoadState& state : set.states) {
        for (mesh::Contact& contact : state.contacts) contact.force *= 1e9;
        for (Reading& reading : state.readings) reading.position = body_.markers[reading.marker].rest;
    }
    DiagnoseOptions options;
    options.law = neo_hookean;
    EXPECT_THROW(diagnose(set, options), SolverFailure);
}

}  // namespace
}  // namespace palpate::identify
