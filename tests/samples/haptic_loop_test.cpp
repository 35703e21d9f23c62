// The sample feels a force that is continuous in time, in and out.

#include "samples/haptic-loop/haptic_loop.h"

#include <gtest/gtest.h>

#include "skeleton/model/io/model_io.h"
#include "tests/skeleton/runtime/live_models.h"
#include "tests/temporary_folder.h"

namespace palpate::runtime {
namespace {

// What a second of it feels like at a rate: ticks x 3.
Points felt(const std::string& model, double rate) {
    Points force(static_cast<Eigen::Index>(rate), 3);
    const double start[3] = {30, 10, 14}, way[3] = {2, 0, -6};
    EXPECT_EQ(haptic_loop(model.c_str(), start, way, rate, static_cast<int>(rate),
                          reinterpret_cast<double(*)[3]>(force.data())),
              0);
    return force;
}

double largest_jump(const Points& force) {
    return (force.bottomRows(force.rows() - 1) - force.topRows(force.rows() - 1)).rowwise().norm().maxCoeff();
}

TEST(HapticLoop, TheForceIsContinuousInAndOut) {
    const TemporaryFolder scratch;
    skeleton::Model model = skeleton::testing::make_full_lattice({4, 3, 2});
    give_skin(model);
    skeleton::write_model(scratch / "model.json", model);
    const Points force = felt((scratch / "model.json").string(), 1000);
    const double most = force.rowwise().norm().maxCoeff();
    EXPECT_GT(most, 1.5);  // [N] of a spring of 0.5 N/mm that is drawn by 6.3 mm and gives way by a third
    // The hand makes 2 pi of its way a second at most: of a force as large as the way, 0.0063 a tick is to be seen, and
    // a little more as the force runs ahead of a body that is damped.
    EXPECT_LT(largest_jump(force), 0.0075 * most);
    // Twice as many ticks, half the jumps, to the order of a tick: so it is where nothing jumps by itself.
    EXPECT_NEAR(largest_jump(felt((scratch / "model.json").string(), 2000)) / largest_jump(force), 0.5, 0.005);
    // It presses against the hand on the way in, and is gone when the hand is back.
    EXPECT_GT(force.row(250).dot(Eigen::RowVector3d(-2, 0, 6)), 0);
    EXPECT_LT(force.row(999).norm(), 3e-4 * most);  // a tick before: 4e-5 of the way, and what the body lags behind
}

TEST(HapticLoop, SaysWhenThereIsNoModel) {
    double force[1][3];
    const double zero[3] = {0, 0, 0};
    EXPECT_EQ(haptic_loop("none.json", zero, zero, 1000, 1, force), 3);
}

}  // namespace
}  // namespace palpate::runtime
