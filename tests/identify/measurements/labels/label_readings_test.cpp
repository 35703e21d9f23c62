#include "identify/measurements/labels/label_readings.h"

#include <gtest/gtest.h>

#include "identify/identify.h"
#include "tests/identify/lattice.h"

namespace palpate::identify {
namespace {

struct MarkedLattice {
    skeleton::Model model = make_lattice({4, 2, 2});
    MeasurementSet set;

    MarkedLattice()
        : set(simulate_measurements(with_truth(model, {1.2}, {400}), push_spheres(model, six_forces(1, 5)),
                                    markers_on_spheres(model), 0.02, 2)) {}

    /// Takes the labels off every `n`th reading, and turns the order of a state's readings round.
    MeasurementSet without_labels(int n) const {
        MeasurementSet result = set;
        int count = 0;
        for (LoadState& state : result.states) {
            for (Reading& reading : state.readings) {
                if (++count % n == 0) reading.marker = -1;
            }
            std::ranges::reverse(state.readings);
        }
        return result;
    }
    /// Of the readings with a label, how many have a wrong one.
    int wrong(const MeasurementSet& labelled) const {
        int count = 0;
        for (std::size_t s = 0; s < set.states.size(); ++s) {
            const auto n = set.states[s].readings.size();
            for (std::size_t r = 0; r < n; ++r) {
                const int label = labelled.states[s].readings[r].marker;
                count += label >= 0 && label != set.states[s].readings[n - 1 - r].marker ? 1 : 0;
            }
        }
        return count;
    }
};

TEST(LabelReadings, ReadingsFindTheirMarkers) {
    const MarkedLattice marked;
    for (const int n : {2, 1}) {  // every second one, all of them
        const MeasurementSet bare = marked.without_labels(n);
        const LabelledSet found = label_readings(bare);
        EXPECT_EQ(marked.wrong(found.set), 0);
        EXPECT_GT(found.matched, 0.95 * (found.matched + found.left_out));

        IdentifyOptions options;
        options.law = LawChoice::large_rotation;
        options.scope = Scope::uniform;
        options.particles = 50;
        const IdentifyResult result = identify(marked.model, bare, options);
        // the noise of 0.02 mm leaves some tenths of a per cent
        EXPECT_NEAR(result.posterior[0].mean, 1.2, 0.003 * 1.2);
        EXPECT_NEAR(result.posterior[1].mean, 400, 0.003 * 400);
        EXPECT_TRUE(std::ranges::any_of(
            result.notes, [](const std::string& note) { return note.find("were given the marker") != note.npos; }));
    }
}

TEST(LabelReadings, MarkersDriftFarAsOneSmoothField) {
    // bent, turned and moved by more than twice what lies between neighbours (8 mm)
    MeasurementSet set;
    LoadState state;
    for (int i = 0; i < 12; ++i) {
        for (int j = 0; j < 6; ++j) {
            const Vec3 rest(8 * i, 8 * j, 3 * std::sin(i + 2 * j));
            const double bend = rest.x() * rest.x() / 500;
            set.markers.push_back({static_cast<int>(set.markers.size()), rest, std::nullopt});
            const Vec3 moved = rest + Vec3(2 - 0.1 * rest.y(), 0.1 * rest.x(), bend);
            state.readings.push_back({-1, moved, missing});
        }
    }
    EXPECT_GT((state.readings.back().position - set.markers.back().rest).norm(), 16);
    set.states.push_back(state);
    const LabelledSet found = label_readings(set);
    EXPECT_EQ(found.left_out, 0);
    for (std::size_t r = 0; r < set.markers.size(); ++r) {
        EXPECT_EQ(found.set.states[0].readings[r].marker, static_cast<int>(r));
    }
}

TEST(LabelReadings, AReadingOfSomeCoordinatesFindsItsMarkerByThem) {
    const MarkedLattice marked;
    MeasurementSet set = marked.without_labels(1000000);
    LoadState& state = set.states[2];
    const int truth = std::exchange(state.readings[3].marker, -1);
    state.readings[3].position.y() = missing;
    // of the two markers that lie behind each other in y, the other one is labelled
    EXPECT_EQ(label_readings(set).set.states[2].readings[3].marker, truth);
}

TEST(LabelReadings, WhatIsNoMarkerIsLeftOut) {
    const MarkedLattice marked;
    MeasurementSet set = marked.without_labels(2);
    set.states[1].readings.push_back({-1, Vec3(1e3, 0, 0), missing});  // a glint
    set.states[1].readings.push_back({-1, Vec3::Constant(missing), missing});
    const LabelledSet found = label_readings(set);
    EXPECT_EQ(found.set.states[1].readings.end()[-1].marker, -1);
    EXPECT_EQ(found.set.states[1].readings.end()[-2].marker, -1);
    EXPECT_GE(found.left_out, 2);
    EXPECT_EQ(notes(found).size(), 2u);
}

TEST(LabelReadings, ASetWithLabelsStaysAsItIs) {
    const MarkedLattice marked;
    const LabelledSet found = label_readings(marked.set);
    EXPECT_EQ(found.matched + found.left_out, 0);
    EXPECT_TRUE(notes(found).empty());
    EXPECT_EQ(marked.wrong(marked.without_labels(1000000)), 0);
}

}  // namespace
}  // namespace palpate::identify
