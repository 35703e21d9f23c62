// Readings one by one, next to all of them at once; and what goes wrong with sensors.

#include "identify/live/filter.h"

#include <gtest/gtest.h>

#include <boost/math/special_functions/gamma.hpp>

#include "identify/identify.h"
#include "identify/inference/methods/methods.h"
#include "identify/numerics/random.h"
#include "identify/numerics/spectrum_update.h"
#include "mesh/errors.h"
#include "tests/identify/lattice.h"
#include "tests/messages.h"

namespace palpate::identify {
namespace {

/// A sheet of two zones whose numbers are asked for, touched again and again.
struct Touched {
    static constexpr double noise = 0.05;  // [mm]
    skeleton::Model model = make_lattice({4, 2, 1}, 2), truth = with_truth(model, {1.4, 2.6}, {500, 900});

    IdentifyOptions options() const {
        IdentifyOptions how;
        how.scope = Scope::zones;
        how.law = LawChoice::large_rotation;
        how.fixed = {skeleton::Stiffness::torsion};
        return how;
    }
    /// Probes `first` and on, of one body.
    MeasurementSet probes(int first, int count, const skeleton::Model& body) const {
        std::vector<Vec3> forces;
        for (int i = first; i < first + count; ++i) {
            const Eigen::VectorXd f = RandomStream(21, 0, i).normals(3);
            forces.emplace_back(3 * f[0], 3 * f[1], 0.3 * f[2]);
        }
        std::vector<LoadState> states = push_spheres(model, forces);
        for (int i = 0; i < count; ++i) states[i].probe = first + i;
        return simulate_measurements(body, states, markers_on_spheres(model), noise,
                                     static_cast<std::uint64_t>(100 + first));
    }
    Filter begun(const MeasurementSet& set, const FilterOptions& how = {}) const {
        return {model, set, calibrate(model, informative_readings(model, set), options(), {}), how};
    }
};

TEST(Filter, TellsWhatTheWholeSetTells) {
    const Touched touched;
    const MeasurementSet begin = touched.probes(1, 6, touched.truth), rest = touched.probes(7, 24, touched.truth);
    Filter filter = touched.begun(begin);
    for (const LoadState& state : rest.states) {
        EXPECT_EQ(filter.assimilate(state).fate, FilterUpdate::Fate::taken_in) << state.probe;
    }
    MeasurementSet whole = begin;
    whole.states.insert(whole.states.end(), rest.states.begin(), rest.states.end());
    IdentifyOptions how = touched.options();
    how.particles = 1000;
    const IdentifyResult batch = identify(touched.model, whole, how);
    const auto compare = [&](double off) {
        const std::vector<PosteriorRow> rows = filter.posterior();
        ASSERT_EQ(rows.size(), batch.posterior.size());
        const Eigen::MatrixXd cloud = filter.particles();
        for (std::size_t p = 0; p < rows.size(); ++p) {
            const PosteriorRow& expected = batch.posterior[p];
            EXPECT_NEAR(rows[p].mean, expected.mean, off * expected.sd) << rows[p].parameter;
            EXPECT_NEAR(rows[p].sd / expected.sd, 1, 0.1) << rows[p].parameter;  // of a thousand particles: 0.03
            EXPECT_EQ(rows[p].informed, expected.informed);
            // five sigma of 200 draws
            const auto column = static_cast<Eigen::Index>(p);
            EXPECT_NEAR(cloud.col(column).mean(), rows[p].mean, 5 * rows[p].sd / std::sqrt(200));
        }
    };
    compare(0.3);
    EXPECT_TRUE(filter.rejuvenate(1));
    compare(0.15);                       // a thousand particles, of which half count, tell a mean to 0.05 sd
    EXPECT_FALSE(filter.rejuvenate(1));  // nothing has come since
    EXPECT_EQ(filter.state().readings, 30);
}

TEST(Filter, SurpriseIsUniformWhereTheModelFits) {
    const Touched touched;
    Filter filter = touched.begun(touched.probes(1, 6, touched.truth));
    constexpr int bins = 10, count = 200;
    std::vector<int> counts(bins);
    for (const LoadState& state : touched.probes(7, count, touched.truth).states) {
        const FilterUpdate update = filter.assimilate(state);
        ++counts[std::min(bins - 1, static_cast<int>(update.p_value * bins))];
        EXPECT_FALSE(update.alarm) << state.probe;
    }
    double chi_squared = 0;
    for (const int in_bin : counts) chi_squared += std::pow(in_bin - count / bins, 2) / (count / bins);
    EXPECT_GT(boost::math::gamma_q((bins - 1) / 2.0, chi_squared / 2), 1e-3);
    EXPECT_LE(filter.state().spectrum.values.size(), 4);  // however many readings: four numbers
}

TEST(Filter, BodyThatChangesRaisesAnAlarmThatSaysSinceWhenAndWhere) {
    const Touched touched;
    Filter filter = touched.begun(touched.probes(1, 6, touched.truth));
    for (const LoadState& state : touched.probes(7, 14, touched.truth).states) filter.assimilate(state);
    const skeleton::Model torn = with_truth(touched.model, {1.4, 1.3}, {500, 300});  // its outer zone
    std::optional<Alarm> alarm;
    int at = 0;
    for (const LoadState& state : touched.probes(21, 12, torn).states) {
        alarm = filter.assimilate(state).alarm;
        if (alarm && at == 0) at = state.probe;
        if (alarm) break;
    }
    ASSERT_TRUE(alarm);
    EXPECT_GE(alarm->since.probe, 20);
    EXPECT_LE(alarm->since.probe, 26);
    EXPECT_GT(alarm->whitened_rms, 2);
    EXPECT_GE(alarm->at.x(), 60);            // links of the outer zone begin at 60 of 120 mm
    EXPECT_EQ(filter.state().readings, 20);  // what surprises is held back
}

TEST(Filter, OneSlipIsHeldBackWithoutAnAlarm) {
    const Touched touched;
    Filter filter = touched.begun(touched.probes(1, 6, touched.truth));
    const Filter& known = filter;
    const Eigen::VectorXd before = known.state().v;
    LoadState slip = touched.probes(7, 1, touched.truth).states.front();
    for (Reading& reading : slip.readings) reading.position.x() += 5;
    const FilterUpdate update = filter.assimilate(slip);
    EXPECT_EQ(update.fate, FilterUpdate::Fate::held_back);
    EXPECT_LT(update.p_value, 1e-10);
    EXPECT_FALSE(update.alarm);
    EXPECT_EQ(known.state().v, before);
}

TEST(Filter, FaultsOfSensorsAreSaidAndSurvived) {
    const Touched touched;
    Filter filter = touched.begun(touched.probes(1, 6, touched.truth));
    std::vector<LoadState> next = touched.probes(7, 8, touched.truth).states;
    const auto fate = [&](const LoadState& state, const char* why) {
        const FilterUpdate update = filter.assimilate(state);
        EXPECT_NE(update.why.find(why), std::string::npos) << update.why;
        return update.fate;
    };
    using enum FilterUpdate::Fate;
    EXPECT_EQ(filter.assimilate(next[0]).fate, taken_in);
    EXPECT_EQ(fate(next[0], "there already"), left_out);  // twice

    LoadState nan = next[1];
    for (Reading& reading : nan.readings) reading.position.setConstant(missing);
    EXPECT_EQ(fate(nan, "no coordinate of a known marker"), left_out);
    LoadState few = next[1];
    few.readings.front().position.y() = std::numeric_limits<double>::infinity();
    few.readings.back().position.setConstant(missing);
    EXPECT_EQ(fate(few, "1 infinite coordinates"), taken_in);

    LoadState unloaded = next[2];
    unloaded.contacts.clear();
    EXPECT_EQ(fate(unloaded, "nothing acts"), left_out);
    LoadState without_force = next[2];
    without_force.contacts.front().force.x() = missing;
    EXPECT_EQ(fate(without_force, "no number"), left_out);

    LoadState late = next[3], early = next[4];
    late.probe = early.probe = 50;
    late.time = 2;
    early.time = 1;
    filter.assimilate(late);
    EXPECT_EQ(fate(early, "out of order"), taken_in);

    // one marker stays where it was, while the load changes
    const Vec3 there = next[5].readings[3].position;
    filter.assimilate(next[5]);
    next[6].readings[3].position = next[7].readings[3].position = there;
    filter.assimilate(next[6]);  // held back or not, as far as it was off
    EXPECT_EQ(fate(next[7], "1 markers are stuck"), taken_in);
}

TEST(Filter, WhatDriftsIsFollowedWhereOldReadingsAreForgotten) {
    const Touched touched;
    const MeasurementSet begin = touched.probes(1, 6, touched.truth);
    // Half of what is known goes with each reading: as many as two are averaged, while stiffness falls by 1 % each.
    Filter forgets = touched.begun(begin, {.forgetting = 0.5}), keeps = touched.begun(begin);
    double now = 1.4;
    int taken_in = 0;
    for (int i = 0; i < 40; ++i) {
        now *= 0.99;  // softer by a third in the end
        const MeasurementSet one = touched.probes(7 + i, 1, with_truth(touched.model, {now, 2.6}, {500, 900}));
        if (forgets.assimilate(one.states.front()).fate == FilterUpdate::Fate::taken_in) ++taken_in;
        keeps.assimilate(one.states.front());
    }
    EXPECT_GE(taken_in, 10);  // the others come before enough is forgotten
    const auto off = [&](const Filter& filter) { return std::abs(filter.posterior().front().mean / now - 1); };
    EXPECT_LT(off(forgets), 0.05);
    EXPECT_GT(off(keeps), 2 * off(forgets));
}

TEST(Filter, BodyThatChangedForGoodIsLearntAnewWhereOldReadingsAreForgotten) {
    const Touched touched;
    Filter filter = touched.begun(touched.probes(1, 6, touched.truth), {.forgetting = 0.7});
    const skeleton::Model torn = with_truth(touched.model, {1.4, 1.3}, {500, 900});  // its outer zone, by half
    bool alarmed = false;
    FilterUpdate last;
    for (const LoadState& state : touched.probes(7, 40, torn).states) {
        last = filter.assimilate(state);
        alarmed |= last.alarm.has_value();
    }
    EXPECT_TRUE(alarmed);
    EXPECT_FALSE(last.alarm);
    EXPECT_EQ(last.fate, FilterUpdate::Fate::taken_in);
    const PosteriorRow outer = filter.posterior()[2];  // elongation of zone 1
    EXPECT_NEAR(outer.mean, 1.3, 4 * outer.sd) << outer.parameter;
    EXPECT_LT(outer.sd, 0.1);
}

TEST(Filter, GoesOnFromWhatItKnew) {
    const Touched touched;
    const MeasurementSet begin = touched.probes(1, 6, touched.truth);
    const std::vector<LoadState> next = touched.probes(7, 10, touched.truth).states;
    Filter through = touched.begun(begin), killed = touched.begun(begin), again = touched.begun(begin);
    for (const LoadState& state : next) through.assimilate(state);
    for (int i = 0; i < 5; ++i) killed.assimilate(next[i]);
    again.resume(killed.state());
    for (int i = 5; i < 10; ++i) again.assimilate(next[i]);
    EXPECT_EQ(again.state().v, through.state().v);
    EXPECT_EQ(again.state().readings, through.state().readings);

    FilterState foreign = killed.state();
    foreign.v.conservativeResize(3);
    try {
        again.resume(foreign);
        FAIL();
    } catch (const InvalidInput& refusal) {
        EXPECT_NE(std::string(refusal.what()).find("belongs to another"), std::string::npos);
    }
}

TEST(Filter, OptionsAndMaterialsThatItCannotTakeAreRefused) {
    const Touched touched;
    const MeasurementSet begin = touched.probes(1, 3, touched.truth);
    for (const FilterOptions& how :
         {FilterOptions{.forgetting = 0}, FilterOptions{.surprise = 0.5}, FilterOptions{.particles = 2}}) {
        EXPECT_THROW(touched.begun(begin, how), InvalidInput);
    }

    skeleton::Model creeps = touched.model;
    creeps.effects.push_back({"viscosity", {{"creep", 0.5, "1"}, {"tau", 2, "s"}}});
    EXPECT_NE(message_of([&] { require_followable(creeps, begin); }).find("remembers its loads"), std::string::npos);
    MeasurementSet rigged = begin;
    rigged.states.front().motions.push_back({});
    EXPECT_NE(message_of([&] { require_followable(touched.model, rigged); }).find("moves tools"), std::string::npos);
}

TEST(SpectrumUpdate, IsThatOfTheSum) {
    constexpr int P = 30;
    Eigen::MatrixXd first(P, 5), more(P, 4);
    for (int i = 0; i < 5; ++i) first.col(i) = RandomStream(1, 0, i).normals(P);
    for (int i = 0; i < 4; ++i) more.col(i) = RandomStream(2, 0, i).normals(P);
    const Spectrum one = added({}, first, 20, 1e-9), both = added(one, more, 20, 1e-9);
    const Eigen::MatrixXd sum = first * first.transpose() + more * more.transpose();
    EXPECT_EQ(both.values.size(), 9);
    EXPECT_LT((both.vectors * both.values.asDiagonal() * both.vectors.transpose() - sum).norm(), 1e-10 * sum.norm());
    // of fewer directions the largest ones
    const Spectrum few = added(one, more, 3, 1e-9);
    EXPECT_LT((few.values - both.values.head(3)).norm(), 1e-10 * both.values[0]);
}

}  // namespace
}  // namespace palpate::identify
