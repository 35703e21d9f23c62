// Intervals mean what they say: the small twin of what identify_bench measures on the paper's experiments.

#include <gtest/gtest.h>

#include <cmath>

#include "identify/identify.h"
#include "lattice.h"

namespace palpate::identify {
namespace {

TEST(Coverage, IntervalsHoldTheTruthAsOftenAsTheySay) {
    const skeleton::Model model = make_lattice({3, 2, 1});
    const skeleton::Model truth = with_truth(model, {1.2}, {400});
    constexpr int repeats = 80;
    int inside = 0, all = 0;
    double squares = 0;  // of the errors over the sd
    for (int i = 0; i < repeats; ++i) {
        const MeasurementSet set =
            simulate_measurements(truth, push_spheres(truth, six_forces(1, 5)), markers_on_spheres(truth), 0.1, 50 + i);
        IdentifyOptions options;
        options.scope = Scope::uniform;
        options.law = LawChoice::large_rotation;
        options.fixed = {skeleton::Stiffness::torsion};
        options.seed = i;
        const IdentifyResult result = identify(model, set, options);
        const double values[] = {1.2, 400};
        for (int p = 0; p < 2; ++p) {
            const PosteriorRow& row = result.posterior[p];
            inside += row.q025 <= values[p] && values[p] <= row.q975 ? 1 : 0;
            squares += std::pow((row.q50 - values[p]) / row.sd, 2);
            ++all;
        }
    }
    // four sigma of a share and of a mean of squares, in 160 of them
    EXPECT_NEAR(static_cast<double>(inside) / all, 0.95, 4 * std::sqrt(0.95 * 0.05 / all));
    EXPECT_NEAR(squares / all, 1, 4 * std::sqrt(2.0 / all));
}

}  // namespace
}  // namespace palpate::identify
