#include "identify/identify.h"

#include <gtest/gtest.h>

#include "identify/comparison/compare.h"
#include "lattice.h"
#include "mesh/errors.h"
#include "tests/messages.h"

namespace palpate::identify {
namespace {

MeasurementSet make_twin(const skeleton::Model& truth, double noise = 0) {
    return simulate_measurements(truth, push_spheres(truth, six_forces(1, 5)), markers_on_spheres(truth), noise, 2);
}

TEST(Identify, ChoosesTheLawThatMadeTheMeasurements) {
    for (const skeleton::EquilibriumLaw law :
         {skeleton::EquilibriumLaw::linear, skeleton::EquilibriumLaw::large_rotation}) {
        const skeleton::Model truth = with_law(with_truth(make_lattice({4, 2, 1}), {1.2}, {400}), law);
        IdentifyOptions options;
        options.scope = Scope::uniform;
        options.particles = 50;
        const IdentifyResult result = identify(make_lattice({4, 2, 1}), make_twin(truth, 0.02), options);
        EXPECT_EQ(result.model.law, law);
        EXPECT_NE(result.notes.front().find("chosen by fit"), std::string::npos);
    }
}

TEST(Identify, FindsTheTruthFromAStartAHundredTimesOff) {
    const skeleton::Model truth = with_truth(make_lattice({4, 2, 1}), {1.2}, {400});
    for (const double factor : {0.01, 100.0}) {
        skeleton::Model start = make_lattice({4, 2, 1});
        for (skeleton::Link& link : start.links) link.stiffness *= factor;
        IdentifyOptions options;
        options.scope = Scope::uniform;
        options.particles = 50;
        const IdentifyResult result = identify(start, make_twin(truth), options);
        EXPECT_NEAR(result.posterior[0].mean, 1.2, 1e-3);  // the model error never falls below 1e-4
        EXPECT_NEAR(result.posterior[1].mean, 400, 0.4);
        EXPECT_LT(compare(result.model, make_twin(truth)).relative, 1e-3);
    }
}

TEST(Identify, EveryLinkHasItsRows) {
    const skeleton::Model truth = with_truth(make_lattice({3, 2, 1}), {1.2}, {400});
    IdentifyOptions options;
    options.particles = 50;
    options.law = LawChoice::large_rotation;
    const IdentifyResult result = identify(make_lattice({3, 2, 1}), make_twin(truth, 0.01), options);
    ASSERT_EQ(result.posterior.size(), 3 * truth.links.size());
    int informed = 0;
    for (std::size_t p = 0; p < result.posterior.size(); ++p) {
        const PosteriorRow& row = result.posterior[p];
        EXPECT_EQ(row.link, static_cast<int>(p / 3));
        EXPECT_EQ(row.unit, skeleton::stiffness_units[p % 3]);
        EXPECT_LE(row.q025, row.q50);
        EXPECT_LE(row.q50, row.q975);
        const double k = result.model.links[p / 3].stiffness[static_cast<int>(p % 3)];
        EXPECT_NEAR(std::log(k), std::log(row.q50), 3.5);  // five sd of the prior's logarithm
        informed += row.informed ? 1 : 0;
    }
    EXPECT_GT(informed, 0);
    // links 0 joins two held spheres: it is unobserved, and its prior stays
    EXPECT_EQ(result.model.links[1].a, 0);
    EXPECT_EQ(result.model.links[1].b, 1);
    EXPECT_FALSE(result.posterior[3].informed);
    EXPECT_NEAR(result.posterior[3].sd / result.posterior[3].prior_sd, 1, 0.5);  // 50 draws of a log-normal
}

TEST(Identify, AModelThatCanFollowDownToTheNoiseDoes) {
    // links that differ by a third, from many readings
    const skeleton::Model start = with_law(make_lattice({4, 3, 3}), skeleton::EquilibriumLaw::linear);
    skeleton::Model truth = start;
    for (std::size_t l = 0; l < truth.links.size(); ++l) {
        truth.links[l].stiffness.head<3>() *= std::exp(0.3 * std::sin(static_cast<double>(l)));
    }
    std::vector<LoadState> states = push_spheres(truth, six_forces(1, 5));
    for (LoadState& more : push_spheres(truth, six_forces(-2, 3))) states.push_back(std::move(more));
    const MeasurementSet set = simulate_measurements(truth, states, markers_on_spheres(truth), 0.01);
    IdentifyOptions options;
    options.particles = 20;
    options.law = LawChoice::linear;
    const IdentifyResult follows = identify(start, set, options);
    EXPECT_LT(follows.model_error, 1e-5);
    // a state's rms of readings that are all noise, less what was fitted
    EXPECT_LT(compare(follows.model, set).relative, 0.02);

    // other physics than the truth's: it cannot
    skeleton::Model bent = with_law(truth, skeleton::EquilibriumLaw::large_rotation);
    std::vector<LoadState> far = push_spheres(bent, six_forces(8, 30));
    const MeasurementSet of_bent = simulate_measurements(bent, far, markers_on_spheres(bent), 0.01);
    const IdentifyResult cannot = identify(start, of_bent, options);
    EXPECT_GT(cannot.model_error, 1e-3);
}

TEST(Identify, NoiseOfAStateNarrowsAsMoreStatesAreMeasured) {
    const skeleton::Model truth = with_truth(make_lattice({4, 2, 1}), {1.2}, {400});
    const auto sd = [&](int repeats) {
        std::vector<LoadState> states;
        for (int i = 0; i < repeats; ++i) {
            for (LoadState& state : push_spheres(truth, six_forces(1, 5))) states.push_back(std::move(state));
        }
        const MeasurementSet set = simulate_measurements(truth, states, markers_on_spheres(truth), 0.1, 4);
        IdentifyOptions options;
        options.scope = Scope::uniform;
        options.law = LawChoice::large_rotation;
        return identify(make_lattice({4, 2, 1}), set, options).posterior[0].sd;
    };
    // sqrt(9) = 3; the model error's estimate adds its own scatter
    EXPECT_NEAR(sd(1) / sd(9), 3, 1.5);
}

TEST(Identify, ThreadsDoNotChangeANumber) {
    const skeleton::Model truth = with_truth(make_lattice({3, 2, 1}), {1.2}, {400});
    const MeasurementSet set = make_twin(truth, 0.05);
    const auto run = [&](int threads) {
        IdentifyOptions options;
        options.particles = 30;
        options.threads = threads;
        return identify(make_lattice({3, 2, 1}), set, options);
    };
    const IdentifyResult one = run(1), three = run(3);
    EXPECT_EQ(one.best, three.best);
    EXPECT_EQ(one.log_evidence, three.log_evidence);
    for (std::size_t p = 0; p < one.posterior.size(); ++p) EXPECT_EQ(one.posterior[p].mean, three.posterior[p].mean);
}

TEST(Identify, UnlabelledReadingsAreLeftOutWithANote) {
    const skeleton::Model truth = with_truth(make_lattice({3, 2, 1}), {1.2}, {400});
    MeasurementSet set = make_twin(truth);
    set.states[0].readings.push_back({-1, Vec3(1e3, 0, 0), missing});
    IdentifyOptions options;
    options.scope = Scope::uniform;
    options.particles = 20;
    const IdentifyResult result = identify(truth, set, options);
    EXPECT_EQ(result.notes.back(), "1 unlabelled readings were left out: their marker is ambiguous");
    EXPECT_NEAR(result.posterior[0].mean, 1.2, 1e-4);  // without noise
}

TEST(Identify, SetsThatTellNothingAreToldToTheUser) {
    const skeleton::Model model = make_lattice({3, 2, 1});
    MeasurementSet unloaded = make_twin(model);
    for (LoadState& state : unloaded.states) state.contacts.clear();
    EXPECT_NE(
        message_of([&] { identify(model, unloaded, {}); }).find("no state with both a load and a labelled reading"),
        std::string::npos);

    MeasurementSet few = simulate_measurements(model, push_spheres(model, {{0, 0, 1}}), markers_on_spheres(model));
    few.states[0].readings.resize(2);
    IdentifyOptions options;
    options.method = Method::burion2008;
    EXPECT_NE(message_of([&] { identify(model, few, options); }).find("at least three markers on each sphere"),
              std::string::npos);
}

TEST(Identify, OptionsNameValueAndBound) {
    const auto message = [](auto change) {
        IdentifyOptions options;
        change(options);
        return message_of([&] { options.validate(); });
    };
    EXPECT_EQ(message([](auto& o) { o.particles = 3; }),
              "option particles is 3; it must be 0 (by the method) or at least 10");
    EXPECT_EQ(message([](auto& o) { o.iterations = 0; }), "option iterations is 0; it must be at least 1");
    EXPECT_EQ(message([](auto& o) { o.search_low = 0; }), "option search_low is 0; it must be above 0");
    EXPECT_EQ(message([](auto& o) { o.search_high = 0.05; }),
              "option search_high is 0.05; it must be above search_low");
    EXPECT_EQ(message([](auto& o) { o.threads = 0; }), "option threads is 0; it must be at least 1");
    EXPECT_EQ(message([](auto&) {}), "");
}

}  // namespace
}  // namespace palpate::identify
