// An effect of area, from the one file of samples/own-effect: known to models, drawn to be hidden, named and measured.

#include <gtest/gtest.h>

#include "identify/diagnosis/diagnose.h"
#include "identify/effects/catalogue.h"
#include "mesh/errors.h"
#include "tests/pipeline/heavy_beam.h"

namespace palpate::pipeline {
namespace {

constexpr double hidden = 0.05;  // [N/mm]: the beam, 20 mm thick and of 1 MPa, is half a millimetre shorter

skeleton::EffectRecord tension(double gamma) { return {"surface-tension", {{"gamma", gamma, "N/mm"}}}; }

/// The beam's own readings, in a skin under tension.
identify::MeasurementSet taut_beam() {
    identify::MeasurementSet set = heavy_beam(false);
    identify::ModelSetting setting{.law = 2, .theta = Eigen::Vector2d(std::log(1.0), std::log(0.1)), .effects = {}};
    setting.effects = skeleton::make_physics(tension(hidden));
    set.position_noise = 0.02;
    read_beam(set, setting, Vec3::Zero(), 11);
    return set;
}

TEST(AreaEffect, IsKnownByOneRow) {
    const auto effect = identify::find_effect("surface-tension");
    EXPECT_EQ(skeleton::find_known_effect(effect->name())->kind, effect->description().kind);
    EXPECT_EQ(skeleton::make_physics(tension(1)).surface.size(), 1);
    EXPECT_THROW(skeleton::make_physics(tension(-1)), InvalidInput);
}

TEST(AreaEffect, IsDrawnInProportionToItsStrength) {
    const identify::MeasurementSet set = heavy_beam(false);
    const Reference reference = make_reference(set, 20);
    const identify::ModelSetting setting{.law = 2, .theta = Eigen::Vector2d(0, std::log(0.1)), .effects = {}};
    const std::vector<double> dwell;
    const std::vector<std::vector<Eigen::VectorXd>> baseline;
    identify::SamplingContext context{.model = *reference.body,
                                      .setting = setting,
                                      .set = set,
                                      .stiffness = 1,
                                      .poisson = 0.45,
                                      .dwell = dwell,
                                      .baseline = baseline,
                                      .random = identify::RandomStream(1, 0, 0)};
    const auto effect = identify::find_effect("surface-tension");
    const auto draw = [&](std::vector<skeleton::EffectParameter> given) {
        return effect->samplers(context, {effect->name(), std::move(given), effect->numbers_to_hide()}).front();
    };
    const auto gamma = [](const identify::EffectSampler& sampler, double strength) {
        return sampler.at(strength).parameters.front().value;
    };
    EXPECT_NEAR(gamma(draw({}), 0.2), 2 * gamma(draw({}), 0.1), 1e-4 * gamma(draw({}), 0.2));  // drawn to five digits
    EXPECT_TRUE(draw({{"gamma", 0.3, "N/mm"}}).is_specified);
    EXPECT_EQ(gamma(draw({{"gamma", 0.3, "N/mm"}}), 7), 0.3);
}

TEST(AreaEffect, IsNamedAndMeasuredOnDataThatHideIt) {
    const identify::MeasurementSet set = taut_beam();
    const Reference reference = make_reference(set, 14);
    const identify::Diagnosis found = identify::diagnose(*reference.body, set, {});
    EXPECT_EQ(found.verdict, identify::Verdict::missing_effect);
    ASSERT_EQ(found.explanation, std::vector<std::string>{"surface-tension"});
    const double gamma = found.explained->estimate("surface-tension").effect.parameters[0].value;
    RecordProperty("gamma", std::to_string(gamma));
    EXPECT_NEAR(gamma, hidden, 0.1 * hidden);  // the coarser mesh costs a few per cent, the noise less
}

}  // namespace
}  // namespace palpate::pipeline
