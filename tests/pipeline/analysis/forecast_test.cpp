#include "pipeline/analysis/forecast/forecast.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

#include "identify/comparison/compare.h"
#include "identify/identify.h"
#include "identify/loading/loads.h"
#include "identify/loading/twin.h"
#include "mesh/errors.h"
#include "mesh/text/atomic_file.h"
#include "pipeline/analysis/particles.h"
#include "pipeline/analysis/quality/probed_body.h"
#include "pipeline/body/body.h"
#include "pipeline/case/subject/subject_body.h"
#include "pipeline/output/results/identification.h"
#include "samples/lattice.h"
#include "skeleton/construction/build.h"
#include "skeleton/statics/equilibrium.h"
#include "tests/messages.h"
#include "tests/temporary_folder.h"

namespace palpate::pipeline {
namespace {

using testing::HasSubstr;

/// A lattice with a skin, so that there is something to forecast.
skeleton::Model cube() {
    skeleton::Model model = samples::make_lattice("cube", {3, 3, 2}, 1);
    model.surface = mesh::make_box({-10, -10, -10}, {90, 90, 50}, {3, 3, 2});
    model.skin.clear();
    for (const auto& vertex : model.surface.vertices.rowwise())
        model.skin.push_back(skeleton::attach_to_links(model, vertex.transpose()));
    return model;
}

std::vector<identify::LoadState> random_pushes(const skeleton::Model& model, int count, std::uint64_t seed) {
    std::mt19937_64 random(seed);
    std::normal_distribution<double> normal;
    std::vector<identify::LoadState> states;
    for (int i = 0; i < count; ++i) {
        Eigen::Index vertex = 0;
        do vertex = static_cast<Eigen::Index>(random() % model.surface.vertices.rows());
        while (model.surface.vertices(vertex, 0) < 20);  // what is held does not move
        const Vec3 force(normal(random), normal(random), normal(random));
        identify::LoadState& state = states.emplace_back();
        state.probe = i;
        state.contacts = {{model.surface.vertices.row(vertex), force, 0}};
    }
    return states;
}

struct Forecasts : testing::Test {
    skeleton::Model truth = cube();
    TemporaryFolder folder;

    /// Identifies the truth's stiffness from noisy pushes, and writes what is found.
    identify::IdentifyResult identified(std::uint64_t seed) {
        const identify::MeasurementSet set = identify::simulate_measurements(
            truth, random_pushes(truth, 6, seed), identify::markers_on_spheres(truth), 0.3, seed);
        skeleton::Model start = truth;
        for (skeleton::Link& link : start.links) link.stiffness *= 1.5;
        identify::IdentifyOptions options;
        options.scope = identify::Scope::uniform;
        options.law = identify::LawChoice::large_rotation;
        options.seed = seed;
        identify::IdentifyResult found = identify::identify(start, set, options);
        write_identification(folder.path(), found);
        return found;
    }
};

TEST_F(Forecasts, IntervalsHoldTheTruth) {
    int held = 0, all = 0;
    for (std::uint64_t seed = 1; seed <= 6; ++seed) {
        const skeleton::Model model = identified(seed).model;
        const std::vector<identify::LoadState> states = random_pushes(truth, 6, 100 + seed);
        const auto uncertainty = read_uncertainty(model, folder.path(), 32);
        ASSERT_TRUE(uncertainty);
        const std::vector<Forecast> told = forecast(model, states, uncertainty, 2);
        const std::vector<Forecast> real = forecast(truth, states, std::nullopt, 2);
        for (std::size_t i = 0; i < states.size(); ++i) {
            held += told[i].low <= real[i].largest && real[i].largest <= told[i].high;
            EXPECT_LT(told[i].high - told[i].low, told[i].largest) << "it says nothing";
            EXPECT_GT(told[i].high - told[i].low, 1e-4 * told[i].largest) << "it claims to know all";
            ++all;
        }
    }
    EXPECT_GE(held, 0.85 * all);  // 95 % of 36 that hang together by the posterior they share
}

Eigen::Index nearest_vertex(const mesh::Surface& surface, const Vec3& point) {
    Eigen::Index nearest = 0;
    (surface.vertices.rowwise() - point.transpose()).rowwise().squaredNorm().minCoeff(&nearest);
    return nearest;
}

/// A bar in finite elements, probed; a skeleton of six spheres, which is coarse, fitted to some of the probes with one
/// number a kind, which no noise leaves in doubt.
struct CoarseForecast {
    explicit CoarseForecast(std::uint64_t seed) {
        Subject subject;
        subject.surface = mesh::make_box({0, 0, 0}, {60, 20, 20}, {6, 2, 2});
        subject.supports = {mesh::BoxRegion{{-1, -1, -1}, {3, 21, 21}}};
        subject.settings.edge_length = 10;
        subject.settings.identify.seed = seed;
        const ProbedQuality probed = probe_for_quality(subject, {.fit = 12, .held_out = 24, .threads = 2});
        held_out = probed.held_out;
        const MeshedBody body = make_body(subject, {.edge_length = 10});
        const identify::IdentifyOptions options{
            .scope = identify::Scope::uniform, .law = identify::LawChoice::linear, .fixed = {}, .threads = 2};
        const identify::IdentifyResult found = identify::identify(
            skeleton::build_skeleton(body.surface, body.volume, subject.material, subject.supports, {.spheres = 6}),
            probed.fit, options);
        model = found.model;
        const TemporaryFolder folder;
        write_identification(folder.path(), found);
        uncertainty = *read_uncertainty(model, folder.path(), 32);
    }

    /// How many of the coordinates held out lie within 1.96 sd, and how many there are.
    std::pair<int, int> within() const {
        const std::vector<Forecast> told = forecast(model, held_out.states, uncertainty, 2);
        const identify::Comparison comparison = identify::compare(model, held_out, 2);
        int held = 0, all = 0;
        for (std::size_t s = 0; s < held_out.states.size(); ++s) {
            if (held_out.states[s].contacts.empty()) continue;
            const auto& readings = held_out.states[s].readings;
            for (std::size_t r = 0; r < readings.size(); ++r) {
                const Vec3& rest = held_out.markers[static_cast<std::size_t>(readings[r].marker)].rest;
                const double sd = told[s].sd[nearest_vertex(model.surface, rest)];
                const Vec3 error =
                    readings[r].position - comparison.predicted[s].row(static_cast<Eigen::Index>(r)).transpose();
                held += static_cast<int>((error.array().abs() <= 1.96 * sd).count());
                all += 3;
            }
        }
        return {held, all};
    }

    skeleton::Model model;
    identify::MeasurementSet held_out;
    ModelUncertainty uncertainty;
};

/// No stiffness mends what a coarse model errs by: intervals that knew of stiffness alone would hold next to nothing.
TEST(ForecastOfACoarseModel, HoldsNinetyFivePercentOfWhatWasNotFitted) {
    int held = 0, all = 0, held_by_stiffness = 0;
    for (std::uint64_t seed = 1; seed <= 3; ++seed) {
        CoarseForecast coarse(seed);
        const auto [within, readings] = coarse.within();
        held += within;
        all += readings;
        coarse.uncertainty.forecast_error = {0, 0, 0};
        held_by_stiffness += coarse.within().first;
    }
    // readings of 72 probes, alike within each: their share scatters by some 1.5 %
    EXPECT_GT(held, 0.90 * all);
    EXPECT_LT(held, 0.99 * all);
    EXPECT_LT(held_by_stiffness, 0.7 * all);
}

TEST_F(Forecasts, OfARigidlyKnownModelAreItsOwn) {
    const Forecast only = forecast(truth, random_pushes(truth, 1, 3), std::nullopt, 1).front();
    EXPECT_EQ(only.sd.size(), 0);
    EXPECT_EQ(only.low, only.largest);
    EXPECT_EQ(only.high, only.largest);
    EXPECT_FALSE(read_uncertainty(truth, folder.path(), 32)) << "there is no posterior in an empty folder";
}

/// One push, held until each time, or gone there.
std::vector<identify::LoadState> held_until(const skeleton::Model& model, const std::vector<double>& times, bool ends) {
    std::vector<identify::LoadState> states;
    for (const double time : times) {
        states.push_back(random_pushes(model, 1, 3).front());
        states.back().time = time;
    }
    if (ends) states.back().contacts.clear();
    return states;
}

TEST_F(Forecasts, StatesCreepUntilTheirTimes) {
    skeleton::Model model = truth;
    model.effects.push_back({"viscosity", {{"creep", 0.5, "1"}, {"tau", 2, "s"}}});
    const std::vector<identify::LoadState> states = held_until(model, {0, 2, 20}, false);
    const std::vector<Forecast> told = forecast(model, states, std::nullopt, 2);
    for (std::size_t s = 0; s < states.size(); ++s) {
        identify::LoadState elastic = states[s];
        for (mesh::Contact& contact : elastic.contacts) contact.force *= 1 + 0.5 * (1 - std::exp(-elastic.time / 2));
        const Points expected = forecast(truth, {elastic}, std::nullopt, 1).front().displacement;
        EXPECT_LT((told[s].displacement - expected).norm(), 1e-7 * expected.norm()) << "at " << elastic.time << " s";
    }
}

TEST_F(Forecasts, WhatHasFlowedStays) {
    skeleton::Model model = truth;
    model.effects.push_back({"plasticity", {{"yield", 1e-3, "1"}, {"hardening", 0.5, "1"}}});
    const std::vector<identify::LoadState> states = held_until(model, {0, 1}, true);
    const std::vector<Forecast> told = forecast(model, states, std::nullopt, 2);
    const skeleton::Equilibrium loaded =
        skeleton::equilibrium(model, identify::ContactLoads(model)(states[0].contacts));
    const skeleton::FibreStates flowed = skeleton::flowed(model, loaded);
    const skeleton::Equilibrium left = skeleton::equilibrium(model, {}, {}, nullptr, flowed);
    EXPECT_GT(told[1].largest, 0.01 * told[0].largest);
    EXPECT_LT((told[1].equilibrium.state.x - left.state.x).norm(), 1e-6 * told[0].largest);
    // another probe is another body
    std::vector<identify::LoadState> apart = states;
    apart[1].probe = apart[0].probe + 1;
    EXPECT_LT(forecast(model, apart, std::nullopt, 2)[1].largest, 1e-9);
}

TEST_F(Forecasts, BeyondTheMeasurementsIsTold) {
    const identify::IdentifyResult found = identified(1);
    const auto uncertainty = read_uncertainty(found.model, folder.path(), 8);
    ASSERT_TRUE(uncertainty);
    EXPECT_EQ(uncertainty->draws.size(), 8u);
    EXPECT_NEAR(uncertainty->measured.force, found.measured.force, 1e-12);
    EXPECT_EQ(uncertainty->measured.places.size(), found.measured.places.size());
    std::vector<Forecast> forecasts(1);
    forecasts[0].largest = found.measured.displacement;
    std::vector<identify::LoadState> states(1);
    states[0].probe = 7;
    states[0].contacts = {{found.measured.places.front(), Vec3(0, 0, found.measured.force), 0}};
    EXPECT_TRUE(extrapolations(uncertainty->measured, states, forecasts, 100).empty());
    states[0].contacts[0].force *= 2;
    EXPECT_THAT(extrapolations(uncertainty->measured, states, forecasts, 100).front(),
                HasSubstr("Probe 7: pressed harder than anything that was measured"));
    states[0].contacts[0].force /= 2;
    states[0].contacts[0].point.z() += 300;
    EXPECT_THAT(extrapolations(uncertainty->measured, states, forecasts, 100).front(),
                HasSubstr("further than 15 mm from"));
    states[0].contacts[0].point.z() -= 300;
    forecasts[0].largest *= 2;
    EXPECT_THAT(extrapolations(uncertainty->measured, states, forecasts, 100).front(),
                HasSubstr("moved further than any"));
}

/// Where no marker was read and nothing was pressed, a model that stands still extrapolates nothing.
TEST(Extrapolations, OfASetWithoutForcesAndMarkersAreOfForcesAlone) {
    std::vector<Forecast> forecasts(1);
    std::vector<identify::LoadState> states(1);
    states[0].probe = 7;
    EXPECT_THAT(extrapolations({}, states, forecasts, 100), testing::IsEmpty());
    states[0].contacts = {{Vec3::Zero(), Vec3(0, 0, 1), 0}};
    forecasts[0].largest = 1;
    EXPECT_THAT(extrapolations({}, states, forecasts, 100),
                testing::ElementsAre(HasSubstr("Probe 7: pressed by a force"), HasSubstr("extrapolates")));
}

TEST_F(Forecasts, ParticlesComeBackAsTheyWereWritten) {
    const identify::IdentifyResult found = identified(2);
    const ParticleSet read = read_particles(folder / "particles.csv");
    const identify::FilterStep& last = found.history.back();
    ASSERT_EQ(read.stiffness.rows(), last.particles.rows());
    ASSERT_EQ(read.stiffness.cols(), last.particles.cols());
    EXPECT_LT((read.stiffness - last.particles).norm(), 1e-5 * last.particles.norm());  // six digits
    EXPECT_LT((read.weights - last.log_weights.array().exp().matrix()).norm(), 1e-5);
    for (std::size_t p = 0; p < found.posterior.size(); ++p)
        EXPECT_EQ(read.parameters[p], found.posterior[p].parameter);
}

/// What tempering leaves of a particle may be less than the least normal number.
TEST_F(Forecasts, ParticlesMayWeighNextToNothing) {
    const auto file = folder.write("particles.csv", "weight,elongation\n1,2\n9.5e-309,3\n");
    EXPECT_LT(read_particles(file).weights[1], 1e-300);
    folder.write("particles.csv", "weight,elongation\n1,2\n,3\n");
    EXPECT_THAT(message_of<InvalidInput>([&] { read_particles(file); }), HasSubstr("'' is no weight"));
}

TEST_F(Forecasts, AnotherModelsParticlesAreRefused) {
    identified(1);
    mesh::write_text(folder / "particles.csv", "weight,elongation:link99\n1,2\n");
    EXPECT_THAT(message_of<InvalidInput>([&] { read_uncertainty(truth, folder.path(), 8); }),
                HasSubstr("'elongation:link99' is no stiffness of the model"));
    mesh::write_text(folder / "particles.csv", "weight,elongation\n1,2\n1\n");
    EXPECT_THAT(message_of<InvalidInput>([&] { read_uncertainty(truth, folder.path(), 8); }),
                HasSubstr("line 3: has 1 cells, its header 2"));
    mesh::write_text(folder / "particles.csv", "weight,elongation\n1,-2\n");
    EXPECT_THAT(message_of<InvalidInput>([&] { read_uncertainty(truth, folder.path(), 8); }),
                HasSubstr("'-2' is no weight"));
}

}  // namespace
}  // namespace palpate::pipeline
