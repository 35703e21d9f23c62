#include <gtest/gtest.h>

#include <cmath>

#include "identify/effects/catalogue.h"
#include "tests/identify/small_body.h"

namespace palpate::identify {
namespace {

TEST(Damage, ShowsWhereLessIsBorneAfterMore) {
    const SmallBody body;
    const auto model = body.reference();
    const auto shows = [&](std::vector<LoadState> states, bool continuous = false) {
        MeasurementSet set = body.set(std::move(states));
        set.continuous = continuous;
        return !find_effect("damage")->numbers(*model, make_problem(set, 0.05)).empty();
    };
    EXPECT_TRUE(shows(SmallBody::returns()));
    // Loads that grow, are held or taken off find each time what is stiff as ever; so does a body of its own.
    EXPECT_FALSE(shows(SmallBody::steps()));
    EXPECT_FALSE(shows(SmallBody::dwells()));
    EXPECT_FALSE(shows(SmallBody::releases()));
    EXPECT_FALSE(shows(SmallBody::probes()));
    // One body that is pressed elsewhere afterwards has softened there, too.
    EXPECT_TRUE(shows(SmallBody::probes(), true));
    // A tool that is drawn back, and an actuator that is let off.
    const auto moved = [&](std::vector<double> ways) {
        std::vector<LoadState> states;
        for (const double way : ways) {
            states.push_back({.probe = 1, .time = static_cast<double>(states.size())});
            if (way > 0) states.back().motions = {{.tool = 0, .translation = Vec3(missing, 0, way)}};
        }
        return shows(states);
    };
    EXPECT_FALSE(moved({1, 2, 2, 0}));
    EXPECT_TRUE(moved({1, 2, 1}));
    std::vector<LoadState> driven{{.probe = 1, .time = 0}, {.probe = 1, .time = 1}};
    driven[0].actuations = {{.actuator = 0, .value = 0.1}};
    driven[1].actuations = {{.actuator = 0, .value = 0.2}};
    EXPECT_FALSE(shows(driven));
    std::swap(driven[0].actuations, driven[1].actuations);
    EXPECT_TRUE(shows(driven));
}

TEST(Damage, ItsShareComesBack) {
    const auto effect = find_effect("damage");
    const SmallBody body;
    const auto numbers = effect->numbers(*body.reference(), make_problem(body.set(SmallBody::returns()), 0.05));
    ASSERT_EQ(numbers.size(), 2U);
    for (const double share : {0.0, 0.4, 0.95}) {
        const skeleton::EffectRecord told{"damage", {{"share", share, "1"}, {"strain", 0.07, "1"}}};
        const skeleton::EffectRecord back = effect->record(numbers, effect->values(numbers, told));
        EXPECT_NEAR(back.parameters[0].value, share, 1e-14);
        EXPECT_NEAR(back.parameters[1].value, 0.07, 1e-14);
    }
    // However far a fit goes, something is left of the material.
    ModelSetting setting;
    effect->enforce(Eigen::Vector2d(30, std::log(0.07)), setting);
    EXPECT_LT(setting.effects.damage->share, 1);
}

}  // namespace
}  // namespace palpate::identify
