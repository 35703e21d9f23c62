#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "identify/diagnosis/search/screen_plan.h"
#include "identify/effects/effect.h"
#include "mesh/errors.h"
#include "mesh/text/words.h"

namespace palpate::identify {
namespace {

/// Tendons rub at the points of their paths, by the turn that they take there (fem/rig/tendon_terms.h).
class FrictionEffect : public EffectHypothesis {
public:
    const EffectDescription& description() const override {
        static const EffectDescription text{
            .name = "friction",
            .kind = EffectKind::body,
            .meaning =
                "Tendons rub where they turn: behind a turn of the angle a the tension is exp(-mu a) times that before "
                "it, while they are drawn in (capstan).",
            .parameters = {"tendons [-]: coefficient of friction mu of all tendons"},
            .reveals =
                "a far end that follows a tendon ever less the more the body bends, and stays behind when it is let "
                "go back",
            .confused_with = {"actuation-gain", "stiffening"},
            .separating_probe =
                "draw the tendon in as far as ever, let it back to half of that, and read both: with friction the body "
                "is bent more at half than on the way there",
            .next_probe = "unload",
            .why_unshown = "no tendon that is drawn in passes a point between its ends, where it could turn and rub"};
        return text;
    }

    std::vector<EffectNumber> numbers(const BodyModel&, const Problem& problem) const override {
        const auto pulls = [&](const Stage& stage) {
            return std::ranges::any_of(stage.action.settings, [&](const mesh::ActuatorSetting& setting) {
                return setting.value > 0 && mesh::may_rub(problem.rig->actuators[setting.actuator]);
            });
        };
        if (std::ranges::none_of(problem.stages, pulls)) return {};
        // from 0.05 in a sheath of PTFE to 0.5 of bare steel on rubber
        return {{.name = "tendons", .unit = "1", .prior_sd = 0.3, .least = 0}};
    }

    bool enforce(const Eigen::VectorXd& values, ModelSetting& setting) const override {
        setting.effects.tendon_friction += values[0];
        return true;
    }

    std::optional<ScreenPlan> screen_plan(const BodyModel& model, const Problem& problem,
                                          const Explanation& explanation,
                                          const ForwardSolution& forward) const override {
        ScreenPlan plan = screen_plan_by_numbers(*this, model, problem, explanation, forward);
        plan.columns = [columns = plan.columns](const Eigen::MatrixXd& sensitivities) {
            ScreenColumns own = columns(sensitivities);
            own.one_sided = true;
            return own;
        };
        plan.start = [](Eigen::Index, const Eigen::VectorXd& screened) {
            return Eigen::VectorXd::Constant(1, std::clamp(screened[0], 0.01, 0.5)).eval();
        };
        return plan;
    }

    std::string sentence(const skeleton::EffectRecord& record) const override {
        return sentence_with(record, Eigen::MatrixXd::Zero(1, 1));
    }

    std::string sentence_with(const skeleton::EffectRecord& record, const Eigen::MatrixXd& covariance) const override {
        const double mu = record.parameters[0].value;
        return fmt::format(
            "The tendons rub where they turn: the coefficient of friction is {}, and a turn of 90 degrees leaves "
            "{:.0f} % of the pull.",
            mesh::with_sd(mu, std::sqrt(covariance(0, 0))), 100 * std::exp(-mu * quarter_turn));
    }

    std::optional<std::uint64_t> stream() const override { return 19; }

    std::vector<EffectSampler> samplers(SamplingContext& context, const SpecifiedNumbers& specified) const override {
        if (std::ranges::none_of(context.set.actuators, mesh::may_rub))
            throw InvalidInput(
                "effect 'friction' is of tendons, and no tendon here passes a point between its ends, where it could "
                "turn; give one a path of three points or more (--tendon), or hide another effect");
        const auto at = [=](double x) { return specified.effect({{"tendons", x}}); };
        return {{.at = at, .start = 0.1, .most = 1, .is_specified = specified.has("tendons")}};
    }

private:
    static constexpr double quarter_turn = 1.5707963267948966;  // [rad]
};

}  // namespace

std::shared_ptr<const EffectHypothesis> friction_effect() { return std::make_shared<FrictionEffect>(); }

}  // namespace palpate::identify
