#include "identify/preflight/suspicions.h"

#include <gtest/gtest.h>

#include "identify/numerics/random.h"
#include "identify/preflight/repeats.h"
#include "tests/identify/small_body.h"

namespace palpate::identify {
namespace {

constexpr double noise = 0.02;  // [mm]

/// Errors of the readings of a set [mm]: noise, and a bend of the whole region that is no reading's own.
Eigen::VectorXd errors(const Problem& problem) {
    RandomStream random(7, 0, 0);
    Eigen::VectorXd error(problem.rows());
    for (Eigen::Index n = 0; n < error.size(); ++n) {
        const double bend = 5e-4 * std::pow(problem.rest(problem.channel(n), 0), 2);
        error[n] = noise * random.normal() + bend * problem.state[n];
    }
    return error;
}

/// A set whose markers lie close enough for their neighbours to tell: one on every 2 mm of a line along the bar.
MeasurementSet dense_set(std::vector<LoadState> states) {
    SmallBody body;
    body.markers.clear();
    for (int i = 0; i < 20; ++i) body.markers.push_back({i, Vec3(2.0 * i + 1, 5, 10), {}});
    MeasurementSet set = body.set(std::move(states));
    set.position_noise = noise;
    return set;
}

Eigen::Index row_of(const Problem& problem, int state, int marker) {
    for (Eigen::Index n = 0; n < problem.rows(); ++n)
        if (problem.state[n] == state && problem.channel(n) == marker) return n;
    return -1;
}

TEST(Suspicions, FindTheReadingThatIsOffAndNoOther) {
    const Problem problem = make_problem(dense_set(SmallBody::probes()), noise);
    Eigen::VectorXd error = errors(problem);
    EXPECT_TRUE(suspicious_readings(problem, error).empty());
    error[row_of(problem, 3, 8)] += 0.5;
    const std::vector<Suspicion> found = suspicious_readings(problem, error);
    ASSERT_EQ(found.size(), 1u);
    EXPECT_EQ(found[0].kind, Suspect::rough);
    EXPECT_EQ(found[0].state, 3);
    EXPECT_EQ(found[0].marker, 8);
    EXPECT_NEAR(found[0].mm, 0.5, 4 * noise);  // 4 sigma of a reading
}

TEST(Suspicions, AMarkerThatIsOffInMostStatesIsToldOnce) {
    const Problem problem = make_problem(dense_set(SmallBody::probes()), noise);
    Eigen::VectorXd error = errors(problem);
    for (int state = 0; state < 8; ++state) error[row_of(problem, state, 11)] += 1;
    const std::vector<Suspicion> found = suspicious_readings(problem, error);
    ASSERT_EQ(found.size(), 1u);
    EXPECT_EQ(found[0].kind, Suspect::everywhere);
    EXPECT_EQ(found[0].marker, 11);
    EXPECT_EQ(found[0].state, -1);
}

TEST(Suspicions, OfFewMarkersTheStatesBeforeAndAfterTell) {
    std::vector<LoadState> states;
    for (int i = 0; i < 6; ++i) {
        LoadState state{.probe = 1, .time = 1.0 * i, .contacts = {{Vec3(36, 5, 10), Vec3(0, 0, -0.01 * i), 3}}};
        states.push_back(state);
    }
    SmallBody body;
    body.markers.resize(4);
    MeasurementSet set = body.set(states);
    const Problem problem = make_problem(set, noise);
    Eigen::VectorXd error = errors(problem);
    EXPECT_TRUE(suspicious_readings(problem, error).empty());
    error[row_of(problem, 2, 1)] += 1;
    const std::vector<Suspicion> found = suspicious_readings(problem, error);
    ASSERT_EQ(found.size(), 1u);
    EXPECT_EQ(found[0].kind, Suspect::jump);
    EXPECT_EQ(found[0].state, 2);
    EXPECT_EQ(found[0].marker, 1);
}

TEST(Suspicions, MarkersOutsideAreFarUnlessAttached) {
    SmallBody body;
    body.markers = SmallBody::with_pins();
    MeasurementSet set = body.set(SmallBody::probes());
    EXPECT_TRUE(markers_off_the_surface(set).empty());
    set.markers.back().anchor.reset();
    set.markers.push_back({26, Vec3(20, 5, 5), {}});  // inside
    const std::vector<Suspicion> found = markers_off_the_surface(set);
    ASSERT_EQ(found.size(), 1u);
    EXPECT_EQ(found[0].marker, 25);
    EXPECT_DOUBLE_EQ(found[0].mm, 6);
}

TEST(Repeats, TellTheNoise) {
    std::vector<LoadState> states = SmallBody::probes(0.03, 3);
    for (const LoadState& state : SmallBody::probes(0.03 * 1.01, 2)) {  // 1 % more: the rig reaches it again
        states.push_back(state);
        states.back().probe += 10;
    }
    const Problem problem = make_problem(SmallBody().set(states), noise);
    const std::vector<Repeat> found = repeated_states(problem, errors(problem));
    ASSERT_EQ(found.size(), 3u);  // the unloaded pose and two loads
    EXPECT_EQ(found[0].states, (std::vector<int>{0, 4}));
    EXPECT_FALSE(found[0].loaded);
    EXPECT_TRUE(found[1].loaded);
    EXPECT_FALSE(found[1].held);
    EXPECT_EQ(found[1].freedoms, 3 * 24);
}

TEST(Repeats, OfNoiseAloneHaveItsSize) {
    std::vector<LoadState> states;
    for (int i = 0; i < 6; ++i) states.push_back({.probe = i, .time = 0});
    const Problem problem = make_problem(SmallBody().set(states), noise);
    RandomStream random(3, 0, 0);
    const Eigen::VectorXd error = noise * random.normals(static_cast<int>(problem.rows()));
    const std::vector<Repeat> found = repeated_states(problem, error);
    ASSERT_EQ(found.size(), 1u);
    EXPECT_EQ(found[0].freedoms, 5 * 3 * 24);
    EXPECT_NEAR(found[0].sd_mm, noise, 4 * noise / std::sqrt(2.0 * found[0].freedoms));  // 4 sigma of an sd
    EXPECT_DOUBLE_EQ(found[0].sigma_mm, noise);
}

TEST(Repeats, OfOneProbeAreHeld) {
    std::vector<LoadState> states = SmallBody::dwells(0.03, 1);
    const Problem problem = make_problem(SmallBody().set(states), noise);
    const auto found = repeated_states(problem, errors(problem));
    const auto held = std::ranges::find_if(found, [](const Repeat& one) { return one.loaded; });
    ASSERT_NE(held, found.end());
    EXPECT_TRUE(held->held);
}

}  // namespace
}  // namespace palpate::identify
