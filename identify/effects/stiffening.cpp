#include "skeleton/effects/stiffening.h"

#include <fmt/format.h>

#include <algorithm>

#include "identify/diagnose/fit.h"
#include "identify/effects/catalogue.h"

namespace palpate::identify {
namespace {

/// A material that grows stiffer as it is stretched: Yeoh's law, C20 = c2 mu and C30 = c3 mu beside mu/2.
class StiffeningEffect : public Effect {
public:
    const EffectDescription& description() const override {
        static const EffectDescription text{
            .name = "stiffening",
            .kind = EffectKind::body,
            .meaning = "The material grows stiffer the more it is strained (Yeoh: C20 = c2 mu, C30 = c3 mu).",
            .parameters = {"c2, c3 [-]: Yeoh's second and third coefficients over the shear modulus"},
            .reveals = "an error that grows faster than the load, at least with its square",
            .confused_with = {"contact", "force-gain", "volume"},
            .separating_probe = "push and pull at one place, at three levels of load",
            .next_probe = "load"};
        return text;
    }

    std::vector<EffectNumber> numbers(const BodyModel&, const Problem&) const override {
        return {{.name = "c2", .unit = "1", .prior_sd = 3, .least = 0},
                {.name = "c3", .unit = "1", .prior_sd = 30, .least = 0}};
    }

    bool enforce(const Eigen::VectorXd& values, Setting& setting) const override {
        setting.effects.material.push_back(std::make_shared<skeleton::Stiffening>(values[0], values[1]));
        return true;
    }

    // It goes with a softer start, which is far from the fit without it.
    bool outwits_screen() const override { return true; }

    ScreenPlan screen_plan(const BodyModel& model, const Problem& problem, const Explanation& explanation,
                           const Played& played) const override {
        // Either coefficient for itself, each over its prior. The linearisation promises more than there is: a refit
        // begins with little.
        ScreenPlan plan = Effect::screen_plan(model, problem, explanation, played);
        plan.columns = [columns = plan.columns](const Eigen::MatrixXd& answers) {
            const ScreenColumns both = columns(answers);
            return ScreenColumns{both.columns * both.prior_sd.asDiagonal(), Eigen::VectorXd::Ones(1), true};
        };
        plan.start = [](Eigen::Index, const Eigen::VectorXd&) { return Eigen::Vector2d(0.3, 0.3); };
        return plan;
    }

    std::string sentence(const skeleton::Effect& told) const override {
        return fmt::format("The material stiffens as it is strained: Yeoh coefficients of {:.3g} and {:.3g} over mu.",
                           told.parameters[0].value, told.parameters[1].value);
    }
};

}  // namespace

std::shared_ptr<const Effect> stiffening_effect() { return std::make_shared<StiffeningEffect>(); }

}  // namespace palpate::identify
