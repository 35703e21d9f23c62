// What no effect explains, as a step of the ladder.

#include <gmock/gmock.h>

#include <cmath>

#include "tests/identify/diagnosis/ladder/ladder_fixture.h"
#include "tests/messages.h"

namespace palpate::identify {
namespace {

using testing::ElementsAre;

TEST_F(LadderTest, AResidualIsAddedWhereItMakesForecastsBetter) {
    const Eigen::VectorXd pull = numbers({32, 5, 5, std::log(4), 0, 0.006, -0.008});
    options_.residual = Residual{.effect = {"local-force", {{"cx", 28, "mm"}, {"fz", -0.01, "N"}}}};
    const Ladder ladder = build_ladder(twin({{"local-force", pull}}), {"local-force"});
    ASSERT_EQ(ladder.steps.size(), 2u);
    EXPECT_LT(ladder.steps[1].reference->held_out_rms_mm, 0.2 * ladder.steps[0].reference->held_out_rms_mm);
    EXPECT_LT(ladder.steps[1].skeleton.held_out_rms_mm, 0.5 * ladder.steps[0].skeleton.held_out_rms_mm);
    EXPECT_EQ(ladder.identified.model.effects.front().name, "local-force");
}

TEST_F(LadderTest, AResidualIsNotAddedWhereItForecastsNothing) {
    options_.residual = Residual{.effect = {"local-force", {}}};
    options_.only_better = true;
    const Ladder ladder = build_ladder(twin({}), {"local-force"});
    EXPECT_EQ(ladder.steps.size(), 1u);
    ASSERT_EQ(ladder.not_added.size(), 1u);
    EXPECT_TRUE(says(ladder.not_added[0].why, {"held-out probes"}));
}

TEST_F(LadderTest, AResidualIsNotAddedWhereNoProbeCanBeHeldOut) {
    options_.residual = Residual{.effect = {"local-force", {}}};
    options_.only_better = true;
    const Ladder ladder = build_ladder(twin({}, 2), {"local-force"});
    ASSERT_TRUE(ladder.held_out_probes.empty());
    ASSERT_EQ(ladder.not_added.size(), 1u);
    EXPECT_TRUE(says(ladder.not_added[0].why, {"too few probes"}));
}

TEST_F(LadderTest, WhatHasANameIsAddedWhereNoProbeCanBeHeldOut) {
    options_.only_better = true;
    const Ladder ladder = build_ladder(twin({{"gravity", half_g_}}, 2), {"gravity"});
    ASSERT_TRUE(ladder.held_out_probes.empty());
    EXPECT_THAT(names_of(ladder.steps.back().effects), ElementsAre("gravity"));
}

}  // namespace
}  // namespace palpate::identify
