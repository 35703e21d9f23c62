#include "identify/diagnosis/problem.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "mesh/errors.h"

namespace palpate::identify {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

const mesh::Contact push{Vec3(1, 0, 0), Vec3(0, 0, -1), 2};
const mesh::Contact stronger{Vec3(1, 0, 0), Vec3(0, 0, -2), 2};
const mesh::Contact nothing{Vec3(1, 0, 0), Vec3::Zero(), 2};

Reading at(int marker, const Vec3& position, double sigma = missing) { return {marker, position, sigma}; }

/// Three markers on the x axis.
MeasurementSet make_set(std::vector<LoadState> states) {
    MeasurementSet set;
    set.name = "three";
    for (int m = 0; m < 3; ++m) set.markers.push_back({10 + m, Vec3(m, 0, 0), {}});
    set.states = std::move(states);
    return set;
}

/// States of which each is read at all markers.
LoadState read(int probe, double time, std::vector<mesh::Contact> contacts) {
    LoadState state{.probe = probe, .time = time, .contacts = std::move(contacts)};
    for (int m = 0; m < 3; ++m) state.readings.push_back(at(m, Vec3(m, 0.1 * probe, time)));
    return state;
}

TEST(LoadSizes, AddUpWithinAKindAsFarAsTheyAreTold) {
    Action action;
    action.contacts = {push, stronger};
    action.motions = {{.tool = 0, .translation = Vec3(3, missing, 4)}};
    const LoadSizes sizes = sizes_of(action);
    EXPECT_EQ(sizes.force, 3);
    EXPECT_EQ(sizes.way, 5);
    EXPECT_EQ(sizes.setting, 0);
}

TEST(Problem, HasARowForEachMeasuredCoordinate) {
    LoadState state{.probe = 3, .contacts = {push}};
    state.readings = {at(1, Vec3(1.5, missing, 0.2)), at(-1, Vec3(9, 9, 9)), at(2, Vec3::Constant(missing)),
                      at(0, Vec3(missing, missing, 0.7))};
    const Problem problem = make_problem(make_set({LoadState{.probe = 1, .contacts = {push}}, state}), 0.1);
    EXPECT_THAT(problem.measured, ElementsAre(1.5, 0.2, 0.7));
    EXPECT_THAT(problem.coordinate, ElementsAre(3, 5, 2));
    EXPECT_THAT(problem.reading, ElementsAre(0, 0, 1));
    EXPECT_THAT(problem.state, ElementsAre(1, 1, 1));  // as the set counts them
    EXPECT_THAT(problem.action, ElementsAre(0, 0, 0));
    EXPECT_EQ(problem.readings(), 2);
    EXPECT_EQ(problem.actions.size(), 1u);  // a state without readings needs none
    EXPECT_EQ(problem.probe[0], 3);
    EXPECT_THAT(problem.displacement(), ElementsAre(0.5, 0.2, 0.7));
    EXPECT_EQ(problem.rest.row(2), Eigen::RowVector3d(2, 0, 0));
}

TEST(Problem, RefusesASetWithoutLabelledReadings) {
    LoadState state{.probe = 1, .contacts = {push}};
    state.readings = {at(-1, Vec3(9, 9, 9))};
    try {
        make_problem(make_set({state}), 0.1);
        FAIL() << "nothing was thrown";
    } catch (const InvalidInput& error) {
        EXPECT_STREQ(error.what(),
                     "measurement set 'three' has no labelled reading; positions.csv needs rows that name a marker");
    }
}

TEST(Problem, StatesWithoutLoadShareOneAction) {
    const Problem problem =
        make_problem(make_set({read(0, 0, {}), read(1, 0, {nothing}), read(1, 1, {push}), read(2, 0, {nothing})}), 0.1);
    ASSERT_EQ(problem.actions.size(), 2u);
    EXPECT_THAT(problem.probe, ElementsAre(-1, 1));
    EXPECT_FALSE(problem.loaded(0));
    EXPECT_TRUE(problem.loaded(1));
    EXPECT_THAT(problem.action, ElementsAre(0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 1, 1, 1, 1, 1, 1,
                                            1, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0));
}

TEST(Problem, RepeatsShareAnActionWithinAProbe) {
    const Problem problem = make_problem(
        make_set({read(1, 1, {push}), read(1, 2, {push}), read(1, 3, {stronger}), read(2, 1, {push})}), 0.1);
    // another probe may have another gain, and its contact another place
    EXPECT_THAT(problem.probe, ElementsAre(1, 1, 2));
    EXPECT_EQ(problem.action[0], problem.action[9]);
    EXPECT_EQ(problem.action[18], 1);
    EXPECT_EQ(problem.action[27], 2);
}

TEST(Problem, KnownGravityActs) {
    MeasurementSet set = make_set({read(0, 0, {}), read(0, 1, {}), read(1, 1, {push})});
    set.gravity = Vec3(0, 0, -9810);
    set.states[1].gravity = Vec3(0, -9810, 0);  // turned
    const Problem problem = make_problem(set, 0.1);
    ASSERT_EQ(problem.actions.size(), 3u);  // a turned body is another action, loaded or not
    EXPECT_EQ(problem.actions[0].gravity, Vec3(0, 0, -9810));
    EXPECT_EQ(problem.actions[1].gravity, Vec3(0, -9810, 0));
    EXPECT_EQ(problem.actions[2].gravity, Vec3(0, 0, -9810));
}

TEST(Problem, AReadingsSigmaWinsOverTheSets) {
    LoadState state{.probe = 1, .contacts = {push}};
    state.readings = {at(0, Vec3(0, 0, 1)), at(1, Vec3(1, 0, 1), 0.5)};
    MeasurementSet set = make_set({state});
    EXPECT_THAT(make_problem(set, 0.1).sigma, ElementsAre(0.1, 0.1, 0.1, 0.5, 0.5, 0.5));
    set.position_noise = 0.2;
    const Problem problem = make_problem(set, 0.1);
    EXPECT_THAT(problem.sigma, ElementsAre(0.2, 0.2, 0.2, 0.5, 0.5, 0.5));
    EXPECT_NEAR(problem.rms_sigma(), std::sqrt((0.04 + 0.25) / 2), 1e-15);
}

TEST(Problem, PicksRowsFromMarkerPositions) {
    const Problem problem = make_problem(make_set({read(1, 1, {push}), read(2, 1, {stronger})}), 0.1);
    std::vector<Points> positions{Points::Constant(3, 3, 1), Points::Constant(3, 3, 2)};
    positions[1](2, 1) = 7;
    const Eigen::VectorXd picked = problem.pick(positions);
    for (Eigen::Index n = 0; n < problem.rows(); ++n) {
        const bool marked = problem.action[n] == 1 && problem.coordinate[n] == 7;
        EXPECT_EQ(picked[n], marked ? 7 : 1 + problem.action[n]);
    }
}

TEST(Problem, WithoutReadingsMatchesItsNumbering) {
    MeasurementSet set = make_set({read(0, 0, {}), read(1, 1, {push}), read(2, 1, {stronger})});
    // what does not count has no number
    set.states[0].readings.insert(set.states[0].readings.begin() + 1, at(-1, Vec3(9, 9, 9)));
    set.states[1].readings.insert(set.states[1].readings.begin(), at(2, Vec3::Constant(missing)));
    set.states[1].readings[2].position.x() = missing;
    const std::vector<int> gone{1, 4, 8};

    const Problem whole = make_problem(set, 0.1);
    std::vector<char> keep;
    for (const int reading : whole.reading) keep.push_back(!std::ranges::binary_search(gone, reading));
    const Problem by_rows = whole.with_rows(keep), by_set = make_problem(without_readings(set, gone), 0.1);
    EXPECT_EQ(by_rows.measured, by_set.measured);
    EXPECT_EQ(by_rows.sigma, by_set.sigma);
    EXPECT_EQ(by_rows.state, by_set.state);
    EXPECT_EQ(by_rows.action, by_set.action);
    EXPECT_EQ(by_rows.coordinate, by_set.coordinate);
    EXPECT_EQ(by_rows.reading, by_set.reading);
    EXPECT_EQ(by_rows.readings(), 6);
    EXPECT_EQ(without_readings(set, gone).states[0].readings.size(), 3u);  // the unlabelled one stays
}

TEST(Problem, WithoutActionsIsTheProblemOfASetWithoutTheirStates) {
    MeasurementSet set = make_set({read(0, 0, {}), read(1, 1, {push}), read(2, 1, {stronger}), read(3, 1, {push})});
    const Problem rest = make_problem(set, 0.1).without_actions({0, 1, 0, 0});
    set.states[1].readings.clear();
    const Problem by_set = make_problem(set, 0.1);
    EXPECT_EQ(rest.actions.size(), 3u);
    EXPECT_EQ(rest.probe, by_set.probe);
    EXPECT_EQ(rest.action, by_set.action);
    EXPECT_EQ(rest.state, by_set.state);
    EXPECT_EQ(rest.reading, by_set.reading);
    EXPECT_EQ(rest.measured, by_set.measured);
}

TEST(Problem, AnotherPressureIsAnotherAction) {
    MeasurementSet set = make_set({read(0, 0, {}), read(0, 1, {}), read(0, 2, {})});
    set.states[1].pressure = 0;  // as if nothing were told
    set.states[2].pressure = 0.01;
    const Problem problem = make_problem(set, 0.1);
    ASSERT_EQ(problem.actions.size(), 2u);
    EXPECT_EQ(problem.actions[0].pressure, 0);
    EXPECT_EQ(problem.actions[1].pressure, 0.01);
}

TEST(Problem, APoissonsRatioIsDeclaredOrMissing) {
    MeasurementSet set = make_set({read(1, 1, {push})});
    EXPECT_TRUE(std::isnan(make_problem(set, 0.1).declared_poisson));
    set.material = MaterialGuess{.young = 0.3};
    EXPECT_TRUE(std::isnan(make_problem(set, 0.1).declared_poisson));
    set.material->poisson = 0.4;
    const Problem problem = make_problem(set, 0.1);
    EXPECT_EQ(problem.declared_poisson, 0.4);
    EXPECT_EQ(problem.stage_by_stage().declared_poisson, 0.4);
    EXPECT_EQ(problem.with_rows(std::vector<char>(9, 1)).declared_poisson, 0.4);
}

TEST(Problem, WithoutWholeStatesKeepsItsActions) {
    const Problem whole = make_problem(make_set({read(1, 1, {push}), read(2, 1, {stronger})}), 0.1);
    std::vector<char> keep(whole.rows(), 1);
    std::fill(keep.begin(), keep.begin() + 9, 0);
    const Problem rest = whole.with_rows(keep);
    EXPECT_EQ(rest.actions.size(), 2u);
    EXPECT_EQ(rest.readings(), 3);
    EXPECT_EQ(rest.reading.front(), 0);
    EXPECT_EQ(rest.action.front(), 1);
}

}  // namespace
}  // namespace palpate::identify
