#include "pipeline/live/set_tail.h"

#include <gtest/gtest.h>

#include "tests/messages.h"
#include "tests/pipeline/live/followed_rig.h"

namespace palpate::pipeline {
namespace {

using identify::LoadState;

/// The next states, so many at least, as they become whole.
std::vector<LoadState> next_states(SetTail& tail, std::size_t count) {
    std::vector<LoadState> states;
    EXPECT_TRUE(comes_true([&] {
        const SetTail::News news = tail.poll();
        states.insert(states.end(), news.states.begin(), news.states.end());
        return states.size() >= count;
    }));
    return states;
}

TEST(SetTail, GivesEachStateOnceAndWhole) {
    const FollowedRig rig;
    SetTail tail(rig.folder / "set");
    EXPECT_EQ(tail.poll().states.size(), 5);  // the last one may go on
    EXPECT_EQ(next_states(tail, 1).size(), 1);
    EXPECT_EQ(tail.poll().states.size(), 0);
    // half a row is none
    std::ofstream(rig.folder / "set/positions.csv", std::ios::app) << "8,1,";
    EXPECT_EQ(tail.poll().states.size(), 0);
    std::filesystem::remove(rig.folder / "set/positions.csv");
    EXPECT_NE(message_of<IoError>([&] { tail.poll(); }).find("positions.csv"), std::string::npos);
}

TEST(SetTail, ReadsWhatTheSetsReaderReads) {
    const FollowedRig rig;
    SetTail tail(rig.folder / "set");
    tail.poll();
    rig.append(6, 8);
    const std::vector<LoadState> states = next_states(tail, 3);
    ASSERT_EQ(states.size(), 3);
    const identify::MeasurementSet whole = identify::read_measurement_set(rig.folder / "set");
    for (std::size_t i = 0; i < 3; ++i) {
        const LoadState& expected = whole.states[5 + i];
        ASSERT_EQ(states[i].probe, expected.probe);
        ASSERT_EQ(states[i].readings.size(), expected.readings.size());
        EXPECT_EQ(states[i].contacts.front().force, expected.contacts.front().force);
        for (std::size_t r = 0; r < expected.readings.size(); ++r) {
            EXPECT_EQ(states[i].readings[r].position, expected.readings[r].position);
        }
    }
}

}  // namespace
}  // namespace palpate::pipeline
