#include "identify/methods/unlabelled.h"

#include <gtest/gtest.h>

#include "lattice.h"

namespace palpate::identify {
namespace {

struct Marked {
    skeleton::Model model = make_lattice({4, 2, 1});
    MeasurementSet set;

    Marked()
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

TEST(Unlabelled, ReadingsFindTheirMarkers) {
    const Marked marked;
    for (const int n : {2, 1}) {  // every second one, all of them
        const MeasurementSet bare = marked.without_labels(n);
        IdentifyOptions options;
        options.law = LawChoice::large_rotation;
        const LabelledSet found = label_readings(marked.model, bare, options);
        EXPECT_EQ(marked.wrong(found.set), 0);
        EXPECT_GT(found.matched, 0.9 * (found.matched + found.left_out));

        options.scope = Scope::uniform;
        options.particles = 50;
        const IdentifyResult result = identify(marked.model, bare, options);
        EXPECT_NEAR(result.posterior[0].mean, 1.2, 0.012);  // the noise of 0.02 mm leaves some tenths of a per cent
        EXPECT_NEAR(result.posterior[1].mean, 400, 8);
    }
}

TEST(Unlabelled, WhatIsNoMarkerIsLeftOut) {
    const Marked marked;
    MeasurementSet set = marked.without_labels(2);
    set.states[1].readings.push_back({-1, Vec3(1e3, 0, 0), missing});  // a glint
    set.states[1].readings.push_back({-1, Vec3::Constant(missing), missing});
    const LabelledSet found = label_readings(marked.model, set, {});
    EXPECT_EQ(found.set.states[1].readings.end()[-1].marker, -1);
    EXPECT_EQ(found.set.states[1].readings.end()[-2].marker, -1);
    EXPECT_GE(found.left_out, 2);
}

TEST(Unlabelled, ASetWithLabelsStaysAsItIs) {
    const Marked marked;
    const LabelledSet found = label_readings(marked.model, marked.set, {});
    EXPECT_EQ(found.matched + found.left_out, 0);
    EXPECT_EQ(marked.wrong(marked.without_labels(1000000)), 0);
}

}  // namespace
}  // namespace palpate::identify
