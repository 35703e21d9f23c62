#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "identify/diagnosis/fit/explanation.h"
#include "identify/effects/body/material/reloading.h"
#include "identify/effects/effect.h"
#include "identify/effects/vector_words.h"

namespace palpate::identify {
namespace {

/// The material is softer wherever it was strained further before: the Mullins effect. The fit's number for the share
/// of stress that may go is -ln(1 - share), which nothing keeps from growing; the other one is the strain's logarithm.
class DamageEffect : public EffectHypothesis {
public:
    const EffectDescription& description() const override {
        static const EffectDescription text{
            .name = "damage",
            .kind = EffectKind::body,
            .meaning =
                "The material is softer after its first large strain (Mullins): below the greatest strain that it ever "
                "bore, not beyond.",
            .parameters = {"share [-]: of its resistance to a change of shape that it may lose",
                           "strain [-]: equivalent strain that makes it softer by 0.84 of that"},
            .reveals =
                "less load after more that moves the body further than it did before it, while nothing of it stays "
                "when the load is gone",
            .confused_with = {"viscosity", "plasticity", "stiffening"},
            .separating_probe =
                "press as hard as ever, go back to half of that, and read both: what is softer moved further at half "
                "than on the way up, what creeps comes back, what yielded stays without load",
            .next_probe = "unload",
            .why_unshown =
                "no body bears less, or something else, after more: under first loads it is as stiff as any"};
        return text;
    }

    std::vector<EffectNumber> numbers(const BodyModel&, const Problem& problem) const override {
        if (!bears_less_after_more(problem)) return {};
        const double strain = std::log(usual_strain);
        return {{.name = "share", .unit = "1", .prior_sd = 1, .least = 0},
                {.name = "strain",
                 .unit = "1",
                 .start = strain,
                 .prior_mean = strain,
                 .prior_sd = 1,
                 .logarithm = true,
                 .weakly_identified = true}};
    }

    bool has_memory() const override { return true; }

    bool enforce(const Eigen::VectorXd& values, ModelSetting& setting) const override {
        setting.effects.damage = fem::Damage{share_of(values[0]), std::exp(values[1])};
        return true;
    }

    skeleton::EffectRecord record(const std::vector<EffectNumber>& numbers,
                                  const Eigen::VectorXd& values) const override {
        skeleton::EffectRecord result = EffectHypothesis::record(numbers, values);
        result.parameters[0].value = share_of(values[0]);
        return result;
    }

    Eigen::VectorXd values(const std::vector<EffectNumber>& numbers,
                           const skeleton::EffectRecord& record) const override {
        Eigen::VectorXd result = EffectHypothesis::values(numbers, record);
        if (!record.parameters.empty()) result[0] = -std::log1p(-std::min(result[0], most_share));
        return result;
    }

    std::optional<ScreenedNumber> screened_number() const override {
        return ScreenedNumber{.name = "share", .unit = "1", .value = [](double value) { return -std::expm1(-value); }};
    }

    std::optional<ScreenPlan> screen_plan(const BodyModel& model, const Problem& problem,
                                          const Explanation& explanation,
                                          const ForwardSolution& forward) const override {
        // The body is led through the undamaged configurations, and is softer in them: what its stress lacks is in
        // proportion to the share, and is the signature for each strain.
        // By factors of two, from a hundredth on: a refit finds what lies between. Each costs a solve in every action.
        constexpr std::array strains{0.01, 0.02, 0.04, 0.08, 0.16, 0.32};
        constexpr double share = 0.5;  // any: it is divided out
        const ModelSetting sound = explanation.setting();
        const auto count = static_cast<int>(problem.actions.size());
        const auto forces = std::make_shared<std::vector<Eigen::MatrixXd>>(
            count, Eigen::MatrixXd::Zero(model.dofs(), std::ssize(strains)));
        for (std::size_t s = 0; s < strains.size(); ++s) {
            ModelSetting damaged = sound;
            damaged.effects.damage = fem::Damage{share, strains[s]};
            std::vector<std::shared_ptr<const Memory>> after(count);
            for (int k = 0; k < count; ++k) {
                Action action = forward.actions[k];
                if (problem.before(k) >= 0) action.memory = after[problem.before(k)];
                (*forces)[k].col(static_cast<Eigen::Index>(s)) =
                    (model.residual(forward.q[k], damaged, action) -
                     model.residual(forward.q[k], sound, forward.actions[k])) /
                    share;
                after[k] = model.remember(forward.q[k], damaged, action);
            }
        }
        ScreenPlan plan;
        plan.signatures = {std::ssize(strains), [forces](int k, const Eigen::VectorXd&) {
                               Signatures::InAction result{.forces = (*forces)[k]};
                               for (int c = 0; c < result.forces.cols(); ++c) result.columns.push_back(c);
                               return result;
                           }};
        plan.columns = [](const Eigen::MatrixXd& sensitivities) {
            return ScreenColumns{sensitivities, Eigen::VectorXd::Constant(1, 1.0), true};
        };
        // No more than a body has that was fitted to loads on their way up and down alike.
        plan.start = [strains](Eigen::Index s, const Eigen::VectorXd& screened) {
            return Eigen::Vector2d(std::clamp(screened[0], 0.05, 0.7), std::log(strains[s]));
        };
        return plan;
    }

    std::string sentence(const skeleton::EffectRecord& record) const override { return sentence_with(record, {}); }

    std::string sentence_with(const skeleton::EffectRecord& record, const Eigen::MatrixXd& covariance) const override {
        const double percent = 100 * std::erf(1.0);
        return fmt::format(
            "The material is softer below the greatest strain that it bore: by {} % after one of {} %, and at most by "
            "{} %.",
            number_in_words(record, 0, covariance, percent), number_in_words(record, 1, covariance, 100),
            number_in_words(record, 0, covariance, 100));
    }

    SynthesisNeeds needs() const override { return {.reloads = true}; }

    std::optional<std::uint64_t> stream() const override { return 18; }

    std::vector<EffectSampler> samplers(SamplingContext& context, const SpecifiedNumbers& specified) const override {
        const double strain = usual_strain * std::exp(context.random.uniform() - 0.5);
        const auto at = [=](double x) { return specified.effect({{"share", x}, {"strain", strain}}); };
        return {{.at = at, .start = 0.4, .most = 0.9, .is_specified = specified.has("share")}};
    }

private:
    static constexpr double usual_strain = 0.05;  // of filled rubber and of tissue that is pressed by a finger
    static constexpr double most_share = 0.999;   // leaves something, and has a finite logarithm to begin a fit with

    static double share_of(double value) { return std::min(-std::expm1(-value), most_share); }
};

}  // namespace

std::shared_ptr<const EffectHypothesis> damage_effect() { return std::make_shared<DamageEffect>(); }

}  // namespace palpate::identify
