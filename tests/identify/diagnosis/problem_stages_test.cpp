#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "identify/diagnosis/problem.h"

// A problem told stage by stage: what a body with a memory goes through.

namespace palpate::identify {
namespace {

using testing::ElementsAre;

const mesh::Contact first_push{Vec3(1, 0, 0), Vec3(0, 0, -1), 2};
const mesh::Contact second_push{Vec3(1, 0, 0), Vec3(0, 0, -2), 2};

/// Unloaded; loaded twice, left alone; loaded otherwise, which was not read, left alone; at rest.
class Stages : public testing::Test {
protected:
    Stages() {
        set_.name = "two";
        for (int m = 0; m < 2; ++m) set_.markers.push_back({m, Vec3(m, 0, 0), {}});
        set_.states = {state(0, 0, {}),  state(1, 1, {first_push}),  state(1, 9, {first_push}),
                       state(1, 20, {}), state(2, 1, {second_push}), state(2, 5, {}),
                       state(3, 0, {})};
        set_.states[4].readings.clear();
        merged_ = make_problem(set_, 0.1);
    }
    static LoadState state(int probe, double time, std::vector<mesh::Contact> contacts) {
        LoadState state{.probe = probe, .time = time, .contacts = std::move(contacts)};
        for (int m = 0; m < 2; ++m) state.readings.push_back({m, Vec3(m, 0.1 * probe, time)});
        return state;
    }
    static std::vector<int> lives(const Problem& problem) {
        std::vector<int> before;
        before.reserve(problem.actions.size());
        for (int k = 0; k < static_cast<int>(problem.actions.size()); ++k) before.push_back(problem.before(k));
        return before;
    }

    MeasurementSet set_;
    Problem merged_;
};

TEST_F(Stages, AreAllStatesWhetherTheyWereReadOrNot) {
    ASSERT_EQ(merged_.stages.size(), 7u);
    for (std::size_t s = 0; s < merged_.stages.size(); ++s) {
        EXPECT_EQ(merged_.stages[s].probe, set_.states[s].probe);
        EXPECT_EQ(merged_.stages[s].time, set_.states[s].time);
        EXPECT_EQ(merged_.stages[s].action.contacts.size(), set_.states[s].contacts.size());
    }
    EXPECT_EQ(merged_.actions.size(), 2u);  // rest, and the first_push
    EXPECT_FALSE(merged_.by_stage);
}

TEST_F(Stages, ToldOneByOneHaveTheSameRows) {
    const Problem stages = merged_.stage_by_stage();
    EXPECT_TRUE(stages.by_stage);
    EXPECT_EQ(stages.measured, merged_.measured);
    EXPECT_EQ(stages.sigma, merged_.sigma);
    EXPECT_EQ(stages.coordinate, merged_.coordinate);
    EXPECT_EQ(stages.reading, merged_.reading);
    EXPECT_EQ(stages.set_reading, merged_.set_reading);
    EXPECT_EQ(stages.state, merged_.state);
    EXPECT_EQ(stages.action, merged_.state);  // an action is a state now
    ASSERT_EQ(stages.actions.size(), stages.stages.size());
    for (std::size_t k = 0; k < stages.actions.size(); ++k) {
        EXPECT_EQ(stages.loaded(static_cast<int>(k)), !set_.states[k].contacts.empty());
    }
    // what is unloaded belongs to the probe whose load was taken off
    EXPECT_THAT(stages.probe, ElementsAre(-1, 1, 1, 1, 2, 2, -1));
}

TEST_F(Stages, ToldOneByOneTwiceAreTheSame) {
    const Problem once = merged_.stage_by_stage(), twice = once.stage_by_stage();
    EXPECT_EQ(twice.actions.size(), once.actions.size());
    EXPECT_EQ(twice.action, once.action);
    EXPECT_EQ(twice.probe, once.probe);
}

TEST_F(Stages, MergeBackToTheActionsThatTheyWere) {
    const Problem stages = merged_.stage_by_stage();
    for (std::size_t n = 0; n < stages.action.size(); ++n) {
        EXPECT_EQ(stages.action_in(merged_, stages.action[n]), merged_.action[n]) << n;
    }
    EXPECT_EQ(stages.action_in(merged_, 4), -1);  // it was not read, and nothing like it
    // what was not read but others are like has their action
    set_.states[2].readings.clear();
    const Problem fewer = make_problem(set_, 0.1);
    EXPECT_EQ(fewer.stage_by_stage().action_in(fewer, 2), fewer.action[2 * 3]);
}

TEST_F(Stages, OfABodyThatEachProbeFindsAsNewBeginWithTheProbe) {
    EXPECT_THAT(lives(merged_.stage_by_stage()), ElementsAre(-1, -1, 1, 2, -1, 4, -1));
}

TEST_F(Stages, OfOneBodyThroughAllAreOneLife) {
    set_.continuous = true;
    EXPECT_THAT(lives(make_problem(set_, 0.1).stage_by_stage()), ElementsAre(-1, 0, 1, 2, 3, 4, 5));
}

TEST_F(Stages, WithoutSomeRowsAreStillLivedThrough) {
    std::vector<char> keep(merged_.rows(), 1);
    std::fill(keep.begin(), keep.begin() + 12, 0);  // of two states
    const Problem rest = merged_.with_rows(keep).stage_by_stage();
    EXPECT_EQ(rest.stages.size(), 7u);
    EXPECT_THAT(lives(rest), ElementsAre(-1, -1, 1, 2, -1, 4, -1));
    EXPECT_EQ(rest.action.front(), 2);
}

TEST_F(Stages, OfActionsThatAreLeftOutAreLivedThroughWithoutTheirLoad) {
    const Problem rest = merged_.without_actions({0, 1});
    const Problem stages = rest.stage_by_stage();
    EXPECT_EQ(stages.actions.size(), 7u);
    EXPECT_FALSE(stages.loaded(1));
    EXPECT_FALSE(stages.loaded(2));
    EXPECT_TRUE(stages.loaded(4));
    // and the same where they were told one by one before
    const Problem other = merged_.stage_by_stage().without_actions({0, 1, 1, 0, 0, 0, 0});
    ASSERT_EQ(other.actions.size(), other.stages.size());
    EXPECT_EQ(other.action, stages.action);
    EXPECT_FALSE(other.loaded(1));
    EXPECT_EQ(other.measured, stages.measured);
}

}  // namespace
}  // namespace palpate::identify
