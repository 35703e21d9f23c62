#include <fmt/format.h>

#include <array>
#include <cmath>

#include "identify/diagnosis/fit/explanation.h"
#include "identify/effects/effect.h"
#include "identify/effects/vector_words.h"

namespace palpate::identify {
namespace {

/// The material yields: where it was strained too far it keeps a permanent set.
class PlasticityEffect : public EffectHypothesis {
public:
    const EffectDescription& description() const override {
        static const EffectDescription text{
            .name = "plasticity",
            .kind = EffectKind::body,
            .meaning = "The material yields beyond some strain, and stays deformed when the load is gone.",
            .parameters = {"yield [-]: equivalent strain at which it yields",
                           "hardening [-]: slope of the stress beyond it, over that before"},
            .reveals = "unloaded states that differ, each after what was done before",
            .confused_with = {"viscosity", "misalignment"},
            .separating_probe = "go back to no load and wait: what creeps comes back, what yielded does not",
            .next_probe = "unload",
            .why_unshown = "no state without load follows a load on the same body"};
        return text;
    }

    std::vector<EffectNumber> numbers(const BodyModel&, const Problem& problem) const override {
        if (!returns_to_rest(problem)) return {};
        // Widely spread guesses, by a factor of 2.7 and of 4.5 either way (1 sd).
        const double yield = std::log(0.03), hardening = std::log(0.05);
        return {{.name = "yield", .unit = "1", .start = yield, .prior_mean = yield, .prior_sd = 1, .logarithm = true},
                {.name = "hardening",
                 .unit = "1",
                 .start = hardening,
                 .prior_mean = hardening,
                 .prior_sd = 1.5,
                 .logarithm = true,
                 .weakly_identified = true}};
    }

    bool has_memory() const override { return true; }

    /// Plastic flow retains and accumulates discretisation error: by 5 % of what it changes, more or less.
    double idealisation_share() const override { return 3e-3; }

    bool enforce(const Eigen::VectorXd& values, ModelSetting& setting) const override {
        setting.effects.plasticity = fem::Plasticity{std::exp(values[0]), std::exp(values[1])};
        return true;
    }

    std::optional<ScreenedNumber> screened_number() const override { return ScreenedNumber{}; }

    std::optional<ScreenPlan> screen_plan(const BodyModel& model, const Problem& problem,
                                          const Explanation& explanation,
                                          const ForwardSolution& forward) const override {
        // The body is led through the elastic configurations, and flows there: what its stress lacks then is the
        // signature, for each yield strain.
        // Round the prior's middle, at most a factor of two apart: a refit finds what lies between. Each costs a solve
        // in every action.
        constexpr std::array yields{0.005, 0.01, 0.02, 0.03, 0.05, 0.08};
        constexpr double hardening = 0.05;  // the prior's middle
        const ModelSetting elastic = explanation.setting();
        const auto count = static_cast<int>(problem.actions.size());
        const auto forces = std::make_shared<std::vector<Eigen::MatrixXd>>(
            count, Eigen::MatrixXd::Zero(model.dofs(), std::ssize(yields)));
        for (std::size_t y = 0; y < yields.size(); ++y) {
            ModelSetting yielding = elastic;
            yielding.effects.plasticity = fem::Plasticity{yields[y], hardening};
            std::vector<std::shared_ptr<const Memory>> after(count);
            for (int k = 0; k < count; ++k) {
                Action action = forward.actions[k];
                if (problem.before(k) >= 0) action.memory = after[problem.before(k)];
                (*forces)[k].col(static_cast<Eigen::Index>(y)) =
                    model.residual(forward.q[k], yielding, action) -
                    model.residual(forward.q[k], elastic, forward.actions[k]);
                after[k] = model.remember(forward.q[k], yielding, action);
            }
        }
        ScreenPlan plan;
        plan.signatures = {std::ssize(yields), [forces](int k, const Eigen::VectorXd&) {
                               Signatures::InAction result{.forces = (*forces)[k]};
                               for (int c = 0; c < result.forces.cols(); ++c) result.columns.push_back(c);
                               return result;
                           }};
        plan.columns = [](const Eigen::MatrixXd& sensitivities) {
            return ScreenColumns{sensitivities, Eigen::VectorXd::Constant(1, 1.0), true};
        };
        plan.start = [yields](Eigen::Index y, const Eigen::VectorXd&) {
            return Eigen::Vector2d(std::log(yields[y]), std::log(hardening));
        };
        // Yield strains from where nothing flows.
        for (double yield = 0.4; yield > 0.003; yield /= 1.5)
            plan.scan.emplace_back(Eigen::Vector2d(std::log(yield), std::log(hardening)));
        return plan;
    }

    std::string sentence(const skeleton::EffectRecord& record) const override { return sentence_with(record, {}); }

    std::string sentence_with(const skeleton::EffectRecord& record, const Eigen::MatrixXd& covariance) const override {
        return fmt::format("The material yields at a strain of {} % and keeps what it flowed beyond.",
                           number_in_words(record, 0, covariance, 100));
    }

    SynthesisNeeds needs() const override { return {.release = true}; }

    std::optional<std::uint64_t> stream() const override { return 10; }

    std::vector<EffectSampler> samplers(SamplingContext&, const SpecifiedNumbers& specified) const override {
        const auto at = [=](double x) { return specified.effect({{"yield", 0.3 / x}, {"hardening", 0.3}}); };
        // Nothing below the yield point, much above it, and soon no equilibrium.
        return {{.at = at, .most = 100, .slope = 6, .growth = 1.3, .is_specified = specified.has("yield")}};
    }

private:
    /// Is the body read without load after a load?
    static bool returns_to_rest(const Problem& problem) {
        bool loaded = false;
        for (std::size_t s = 0; s < problem.stages.size(); ++s) {
            const Stage& stage = problem.stages[s];
            if (!problem.continuous && s > 0 && stage.probe != problem.stages[s - 1].probe) loaded = false;
            if (loaded && stage.action.contacts.empty()) return true;
            loaded = loaded || !stage.action.contacts.empty();
        }
        return false;
    }
};

}  // namespace

std::shared_ptr<const EffectHypothesis> plasticity_effect() { return std::make_shared<PlasticityEffect>(); }

}  // namespace palpate::identify
