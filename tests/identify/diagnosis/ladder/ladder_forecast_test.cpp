#include "identify/diagnosis/ladder/ladder_forecast.h"

#include <gtest/gtest.h>

#include "tests/messages.h"

namespace palpate::identify {
namespace {

LadderStep step_with(const std::string& effect, double held_out_mm, double whitened) {
    LadderStep step;
    if (!effect.empty()) step.effects = {{effect, {}}};
    step.skeleton.held_out_rms_mm = held_out_mm;
    step.reference = StepError{.held_out_rms_mm = held_out_mm, .held_out_whitened_rms = whitened};
    return step;
}

TEST(LadderForecast, SaysWhatIsWorseAndByHowMuch) {
    const LadderStep before = step_with("", 0.3, 1.5);
    EXPECT_FALSE(what_is_worse(before, step_with("gravity", 0.32, 1.5), 1.1));
    const auto worse = what_is_worse(before, step_with("gravity", 0.6, 0.9), 1.1);
    ASSERT_TRUE(worse);
    EXPECT_TRUE(says(*worse, {"finite-element model", "0.6 mm", "0.3 mm without it"}));
}

/// Gains of single probes: those of held-out ones are not known, and the body's forecast allows for that. What else the
/// step has found, as outliers do after the effect that is added, does not matter.
TEST(LadderForecast, OfAFaultItsSpreadIsKnown) {
    const LadderStep before = step_with("", 0.3, 1.5);
    EXPECT_TRUE(is_forecast_by_its_spread("force-gain", before, step_with("force-gain", 0.6, 0.9)));
    EXPECT_FALSE(is_forecast_by_its_spread("force-gain", before, step_with("force-gain", 0.6, 1.6)));
    LadderStep gravity = step_with("gravity", 0.6, 0.9);
    gravity.effects.push_back({"outliers", {}});
    EXPECT_FALSE(is_forecast_by_its_spread("gravity", before, gravity));
    LadderStep skeleton_alone = step_with("force-gain", 0.6, 0.9);
    skeleton_alone.reference.reset();
    EXPECT_FALSE(is_forecast_by_its_spread("force-gain", before, skeleton_alone));
}

}  // namespace
}  // namespace palpate::identify
