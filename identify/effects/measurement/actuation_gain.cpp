#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "identify/effects/effect.h"
#include "identify/effects/measurement/gains.h"
#include "mesh/errors.h"

namespace palpate::identify {
namespace {

/// An actuator does less, or more, than it is set to: a gauge that is off, a hose that loses pressure, a tendon that
/// rubs. A gain that all actuators share, where nothing but they load the body, is exactly another stiffness.
class ActuationGainEffect : public EffectHypothesis {
public:
    const EffectDescription& description() const override {
        static const EffectDescription text{
            .name = "actuation-gain",
            .kind = EffectKind::measurement,
            .meaning = "The true pressure, tension or length of an actuator is a multiple of the reported one.",
            .parameters = {"gain of <actuator> [-]: true over reported value of that actuator"},
            .reveals = "states that are off in proportion to what one actuator is set to",
            .confused_with = {"stiffening", "pressure"},
            .separating_probe = "press on the body with a known force: its stiffness is apart from the gains then",
            .next_probe = "load",
            .why_unshown = "no actuator acts, or its gain is the body's stiffness"};
        return text;
    }

    std::vector<EffectNumber> numbers(const BodyModel&, const Problem& problem) const override {
        std::vector<EffectNumber> result;
        for (const int actuator : used_actuators(problem)) {
            // as for a force sensor
            result.push_back({.name = "gain of " + problem.rig->actuators[actuator].name,
                              .unit = "1",
                              .prior_sd = 0.3,
                              .logarithm = true});
        }
        const bool is_common = result.size() == 1 && !tells_stiffness_otherwise(problem);
        return is_common ? std::vector<EffectNumber>{} : result;
    }

    Action act(const Problem& problem, int, Action action, const Eigen::VectorXd& values) const override {
        const std::vector<int> actuators = used_actuators(problem);
        for (mesh::ActuatorSetting& setting : action.settings) {
            const auto own = std::ranges::find(actuators, setting.actuator);
            if (own != actuators.end()) setting.scale(std::exp(values[own - actuators.begin()]));
        }
        return action;
    }

    std::string sentence(const skeleton::EffectRecord& record) const override { return sentence_with(record, {}); }

    std::string sentence_with(const skeleton::EffectRecord& record, const Eigen::MatrixXd& covariance) const override {
        const auto [least, most] = gain_range(record, covariance);
        if (record.parameters.size() == 1)
            return fmt::format("An actuator does not do what it is set to: the {} is {}.", least.name, least.in_words);
        return fmt::format("Actuators do not do what they are set to: the {} is {}, the {} {}.", least.name,
                           least.in_words, most.name, most.in_words);
    }

    MeasurementSet corrected(const MeasurementSet& set, const skeleton::EffectRecord& record) const override {
        MeasurementSet result = set;
        for (LoadState& state : result.states) {
            for (Actuation& actuation : state.actuations) {
                const auto own =
                    std::ranges::find(record.parameters, "gain of " + set.actuators[actuation.actuator].name,
                                      &skeleton::EffectParameter::name);
                if (own != record.parameters.end()) actuation.value *= own->value;
            }
        }
        return result;
    }

    void hide(const skeleton::EffectRecord& record, TrueConditions& conditions) const override {
        conditions.actuator_gain = number_of(record, "gain");
    }

    std::vector<skeleton::KnownParameter> numbers_to_hide() const override { return {{"gain", "1"}}; }
    std::optional<std::uint64_t> stream() const override { return 21; }

    /// Of the first actuator.
    std::vector<EffectSampler> samplers(SamplingContext& context, const SpecifiedNumbers& specified) const override {
        const bool is_common = context.set.actuators.size() == 1 && context.set.tools.empty();
        if (context.set.actuators.empty() || is_common) {
            throw InvalidInput(
                "effect 'actuation-gain' needs another actuator or a tool beside the first actuator, as a gain that "
                "all loads share is the body's stiffness: add a --cavity, a --tendon or --tool");
        }
        return gain_samplers(context, specified);
    }

private:
    static std::vector<int> used_actuators(const Problem& problem) {
        std::vector<int> used;
        for (const Stage& stage : problem.stages) {
            for (const mesh::ActuatorSetting& setting : stage.action.settings) {
                if (std::ranges::find(used, setting.actuator) == used.end()) used.push_back(setting.actuator);
            }
        }
        std::ranges::sort(used);
        return used;
    }

    /// Does a force, or a tool, load the body in some state?
    static bool tells_stiffness_otherwise(const Problem& problem) {
        return std::ranges::any_of(problem.stages, [](const Stage& stage) {
            return !stage.action.contacts.empty() || !stage.action.motions.empty() || !stage.action.gravity.isZero(0);
        });
    }
};

}  // namespace

std::shared_ptr<const EffectHypothesis> actuation_gain_effect() { return std::make_shared<ActuationGainEffect>(); }

}  // namespace palpate::identify
