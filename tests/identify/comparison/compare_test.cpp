#include "identify/comparison/compare.h"

#include <gtest/gtest.h>

#include "identify/comparison/load_exponent.h"
#include "identify/effects/catalogue.h"
#include "mesh/errors.h"
#include "tests/identify/lattice.h"
#include "tests/identify/small_body.h"

namespace palpate::identify {
namespace {

MeasurementSet noisy_twin(const skeleton::Model& model, double noise, int rounds = 5) {
    std::vector<LoadState> states;
    for (int i = 0; i < rounds; ++i) {
        for (LoadState state : push_spheres(model, six_forces(6, 6))) {
            state.probe += 6 * i;
            states.push_back(std::move(state));
        }
    }
    return simulate_measurements(model, states, markers_on_spheres(model), noise, 11);
}

TEST(Compare, TheTruthLeavesNoiseOnly) {
    const skeleton::Model model = make_lattice({3, 3, 2});
    const Comparison comparison = compare(model, noisy_twin(model, 0.1));
    const double n = 30 * 48 * 3;
    EXPECT_NEAR(comparison.rms, 0.1, 0.1 * 4 / std::sqrt(2 * n));  // four sigma
    EXPECT_NEAR(comparison.noise, 0.1, 1e-12);                     // rounding
    EXPECT_TRUE(comparison.adequate);
    EXPECT_GT(comparison.p_value, 1e-4);
    EXPECT_LT(comparison.p_value, 1 - 1e-4);
    EXPECT_EQ(comparison.probes.size(), 30U);
    EXPECT_EQ(comparison.worst.size(), 10U);
    EXPECT_EQ(comparison.max, comparison.worst[0].error);
}

TEST(Compare, AWrongStiffnessIsNotAdequateAndGrowsWithTheLoad) {
    skeleton::Model model = make_lattice({3, 3, 2});
    model.law = skeleton::EquilibriumLaw::linear;
    std::vector<LoadState> states = push_spheres(model, {{0, 0, -1}, {0, 0, -2}, {0, 0, -4}});
    for (LoadState& state : states) state.contacts[0].point = model.spheres.back().center;
    states.emplace_back();  // unloaded
    const MeasurementSet set =
        simulate_measurements(with_truth(model, {1.5}, {500}), states, markers_on_spheres(model), 0.001);
    const Comparison comparison = compare(model, set);
    EXPECT_FALSE(comparison.adequate);
    EXPECT_LT(comparison.p_value, 1e-9);
    ASSERT_TRUE(comparison.load_exponent.has_value());
    EXPECT_NEAR(comparison.load_exponent->value, 1, 0.02);  // noise is a thousandth of the error
    EXPECT_NE(comparison.load_exponent->words.find("in proportion"), std::string::npos);
    // softer by a quarter and a third: between a fifth and a third of the displacement is missed
    EXPECT_GT(comparison.relative, 0.2);
    EXPECT_LT(comparison.relative, 0.34);
}

TEST(Compare, ALoadThatIsTooMuchIsPlayedAsFarAsItIsBorne) {
    // A lattice that flows, pulled at its top: somewhere there is a load that it does not bear.
    skeleton::Model model = make_lattice({3, 3, 2});
    model.law = skeleton::EquilibriumLaw::large_rotation;
    model.effects = {{"plasticity", {{"yield", 0.01, "1"}, {"hardening", 1e-4, "1"}}}};
    std::vector<LoadState> states = push_spheres(model, {{0, 0, 0.01}});
    states[0].contacts[0].point = model.spheres.back().center;
    MeasurementSet set = simulate_measurements(model, states, markers_on_spheres(model));
    EXPECT_LT(compare(model, set).probes[0].rms, 1e-6);
    for (int attempt = 0; attempt < 20; ++attempt) {
        set.states[0].contacts[0].force *= 2;
        const Comparison comparison = compare(model, set);
        if (comparison.overloaded_probes.empty()) continue;
        EXPECT_EQ(comparison.overloaded_probes, std::vector<int>{set.states[0].probe});
        EXPECT_TRUE(std::isfinite(comparison.rms));
        EXPECT_GT(comparison.probes[0].rms, 1e-3);

        // also on the way to a state that is read
        LoadState let_go = set.states[0];
        let_go.contacts.clear();
        let_go.time += 1;
        set.states[0].readings.clear();
        set.states.push_back(let_go);
        EXPECT_EQ(compare(model, set).overloaded_probes, std::vector<int>{let_go.probe});
        return;
    }
    FAIL() << "it bears everything";
}

TEST(Compare, ABodyThatYieldsIsPlayedThroughWhatItLived) {
    const SmallBody body;
    const auto bar = body.skeleton();
    const Eigen::Vector2d values(std::log(0.02), std::log(0.3));
    const auto plasticity = find_effect("plasticity");
    for (const bool continuous : {true, false}) {
        MeasurementSet blank = body.set(SmallBody::releases());
        blank.continuous = continuous;
        const MeasurementSet set = make_twin(*bar, blank, with(bare_truth(*bar, 1), plasticity, values), 0);
        skeleton::Model model = body.chain();
        model.law = skeleton::EquilibriumLaw::large_rotation;
        model.effects = {plasticity->record(plasticity->numbers(*bar, make_problem(set, 1)), values)};
        EXPECT_LT(compare(model, set).rms, 1e-6) << continuous;

        // A state that is not read is lived through all the same.
        MeasurementSet some = set;
        some.states[1].readings.clear();
        some.states[2].readings.clear();
        EXPECT_LT(compare(model, some).rms, 1e-6) << continuous;
        // Its set shows: without the memory the unloaded states would be as new.
        double unloaded = 0;
        for (const LoadState& state : set.states) {
            if (!state.contacts.empty()) continue;
            for (const Reading& r : state.readings) {
                unloaded = std::max(unloaded, (r.position - set.markers[r.marker].rest).norm());
            }
        }
        EXPECT_GT(unloaded, 0.1) << continuous;
    }
}

TEST(Compare, WorstReadingPointsFromTheModelToTheMeasurement) {
    const skeleton::Model model = make_lattice({3, 1, 1});
    MeasurementSet set = simulate_measurements(model, push_spheres(model, {{0, 0, 1}}), markers_on_spheres(model));
    set.markers[5].id = 77;
    set.states[0].readings[5].position.y() += 2;
    const Comparison comparison = compare(model, set);
    EXPECT_EQ(comparison.worst[0].marker, 77);
    EXPECT_EQ(comparison.worst[0].probe, 1);
    EXPECT_NEAR(comparison.worst[0].error, 2, 1e-9);
    EXPECT_LT((comparison.worst[0].towards - Vec3::UnitY()).norm(), 1e-9);
    EXPECT_EQ(comparison.worst[0].at, set.states[0].readings[5].position);
    EXPECT_NEAR(comparison.rms, 2 / std::sqrt(24), 1e-9);  // eight markers, three coordinates each
}

TEST(Compare, UnlabelledAndMissingReadingsAreLeftOut) {
    const skeleton::Model model = make_lattice({3, 1, 1});
    MeasurementSet set = simulate_measurements(model, push_spheres(model, {{0, 0, 1}}), markers_on_spheres(model));
    auto& readings = set.states[0].readings;
    readings[0].marker = -1;
    readings[0].position.setConstant(1e3);
    readings[1].position.x() = missing;
    const Comparison comparison = compare(model, set);
    EXPECT_NEAR(comparison.rms, 0, 1e-9);
    ASSERT_EQ(comparison.predicted.size(), 1U);
    ASSERT_EQ(comparison.predicted[0].rows(), 8);
    EXPECT_TRUE(std::isnan(comparison.predicted[0](0, 0)));
    EXPECT_LT((comparison.predicted[0].row(2).transpose() - readings[2].position).norm(), 1e-9);
}

TEST(Compare, WithoutNoiseItDoesNotJudge) {
    const skeleton::Model model = make_lattice({3, 1, 1});
    MeasurementSet set = simulate_measurements(model, push_spheres(model, {{0, 0, 1}}), markers_on_spheres(model));
    const Comparison comparison = compare(model, set);
    EXPECT_TRUE(std::isnan(comparison.noise));
    EXPECT_TRUE(std::isnan(comparison.p_value));
    EXPECT_FALSE(comparison.adequate);
    EXPECT_FALSE(comparison.load_exponent.has_value());
}

TEST(Compare, ThreadsDoNotChangeANumber) {
    const skeleton::Model model = make_lattice({3, 3, 1});
    const MeasurementSet set = noisy_twin(model, 0.1, 1);
    const Comparison one = compare(model, set, 1), three = compare(model, set, 3);
    EXPECT_EQ(one.rms, three.rms);
    EXPECT_EQ(one.predicted, three.predicted);
}

TEST(Compare, ASetWithoutReadingsIsToldToTheUser) {
    const skeleton::Model model = make_lattice({3, 1, 1});
    MeasurementSet set;
    set.name = "empty";
    set.states.emplace_back();
    try {
        compare(model, set);
        FAIL() << "no exception";
    } catch (const InvalidInput& error) {
        EXPECT_NE(std::string(error.what()).find("'empty' has no labelled reading"), std::string::npos);
    }
}

TEST(Compare, ASetThatReadsMomentsAloneIsToldToTheUser) {
    const SmallBody body;
    MeasurementSet set = body.set({});
    set.markers.clear();
    set.tools = {{.name = "grip",
                  .shape = mesh::GripShape{{mesh::BoxRegion{Vec3(34, -1, -1), Vec3(41, 11, 11)}}},
                  .bonded = true,
                  .origin = Vec3(40, 5, 5)}};
    LoadState turned{.probe = 1, .time = 1};
    turned.motions = {{.tool = 0, .rotation = Vec3(0.05, 0, 0)}};
    turned.reactions = {{.tool = 0, .moment = Vec3(0.5, 0, 0)}};
    set.states = {turned};
    try {
        compare(body.chain(), set);
        FAIL() << "no exception";
    } catch (const InvalidInput& error) {
        const std::string words = error.what();
        for (const char* word : {"'bar' tells neither a position nor a force", "positions.csv", "reactions.csv forces"})
            EXPECT_NE(words.find(word), std::string::npos) << words;
    }
    // With one component of the force it is compared.
    set.states[0].reactions[0].force.x() = 0;
    const Comparison comparison = compare(body.chain(), set);
    ASSERT_TRUE(comparison.reactions.has_value());
    ASSERT_EQ(comparison.reactions->forces.size(), 1U);
    const ToolForce& force = comparison.reactions->forces.front();
    EXPECT_EQ(force.probe, 1);
    EXPECT_EQ(force.error(), std::abs(force.modelled.x())) << "nothing was read along y and z";
    EXPECT_EQ(force.error(), comparison.reactions->max);
}

/// States whose error is a + b load^p, with a little noise taken off.
std::vector<ErrorUnderLoad> errors(double p, bool unloaded) {
    std::vector<ErrorUnderLoad> states;
    for (const double load : {1.0, 2.0, 3.0, 1.1, 2.2, 2.9}) {
        states.push_back({load, std::hypot(0.5 * std::pow(load, p), 0.01), 0.01, 100});
    }
    if (unloaded) states.push_back({0, std::hypot(p == 0 ? 0.5 : 0.0, 0.01), 0.01, 100});
    return states;
}

TEST(LoadExponent, FindsThePower) {
    for (const bool unloaded : {false, true}) {
        for (const double p : {0.0, 1.0, 2.0}) {
            const auto exponent = load_exponent(errors(p, unloaded));
            ASSERT_TRUE(exponent.has_value());
            EXPECT_NEAR(exponent->value, p, 1e-6);  // the noise is taken off exactly
        }
        EXPECT_NE(load_exponent(errors(0, unloaded))
                      ->words.find(unloaded ? "is there without any load" : "an unloaded state is needed"),
                  std::string::npos);
        EXPECT_NE(load_exponent(errors(2, unloaded))->words.find("nonlinearity"), std::string::npos);
    }
}

TEST(LoadExponent, AnErrorThatIsThereWithoutLoadSaysZero) {
    std::vector<ErrorUnderLoad> states;
    states.reserve(7);
    for (int i = 0; i < 6; ++i) states.push_back({5, 0.5 + 0.01 * i, 0.01, 100});
    EXPECT_FALSE(load_exponent(states).has_value());  // one load level
    states.push_back({1e-14, 0.52, 0.01, 100});       // rounding is no load
    const auto exponent = load_exponent(states);
    ASSERT_TRUE(exponent.has_value());
    EXPECT_NEAR(exponent->value, 0, 0.05);  // scatter of a few per cent over a wide range of loads
}

TEST(LoadExponent, PlacesThatDifferMoreThanLoadsAreNoErrorWithoutLoad) {
    std::vector<ErrorUnderLoad> states;
    for (int i = 0; i < 60; ++i) states.push_back({5 * std::exp(-0.065 * i), 0.5 * std::exp(0.016 * i), 0.01, 100});
    EXPECT_NE(load_exponent(states)->words.find("an unloaded state is needed"), std::string::npos);
    states.back().loaded = false;  // its own weight alone moves it
    EXPECT_EQ(load_exponent(states)->words, "the errors do not grow with the load");
    states.push_back({0, 0.01, 0.01, 100});  // it was read, and is right
    EXPECT_NE(load_exponent(states)->words.find("nothing is wrong without load"), std::string::npos);
    states.push_back({0, 0.5, 0.01, 100});  // at another time it is not
    EXPECT_NE(load_exponent(states)->words.find("there without any load"), std::string::npos);
}

}  // namespace
}  // namespace palpate::identify
