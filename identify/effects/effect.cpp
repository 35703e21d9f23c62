#include "identify/effects/effect.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace palpate::identify {

bool EffectHypothesis::enforce(const Eigen::VectorXd&, ModelSetting&) const { return false; }

Action EffectHypothesis::act(const Problem&, int, Action action, const Eigen::VectorXd&) const { return action; }

Eigen::VectorXd EffectHypothesis::under(const ProbeConditions&, const Eigen::VectorXd& values) const { return values; }

Points EffectHypothesis::see(const Problem&, const Points& markers, const Eigen::VectorXd&) const { return markers; }

std::optional<ScreenPlan> EffectHypothesis::screen_plan(const BodyModel&, const Problem&, const Explanation&,
                                                        const ForwardSolution&) const {
    return std::nullopt;
}

std::string EffectHypothesis::sentence_with(const skeleton::EffectRecord& record, const Eigen::MatrixXd&) const {
    return sentence(record);
}

std::string EffectHypothesis::objection(const Problem&, const Eigen::VectorXd&) const { return {}; }

skeleton::EffectRecord EffectHypothesis::record(const std::vector<EffectNumber>& numbers,
                                                const Eigen::VectorXd& values) const {
    assert(std::ssize(numbers) == values.size());
    skeleton::EffectRecord result{name(), {}};
    for (std::size_t j = 0; j < numbers.size(); ++j) {
        const double value = values[static_cast<Eigen::Index>(j)];
        result.parameters.push_back({numbers[j].name, numbers[j].logarithm ? std::exp(value) : value, numbers[j].unit});
    }
    return result;
}

Eigen::VectorXd EffectHypothesis::values(const std::vector<EffectNumber>& numbers,
                                         const skeleton::EffectRecord& record) const {
    Eigen::VectorXd result(std::ssize(numbers));
    for (Eigen::Index j = 0; j < result.size(); ++j) {
        const EffectNumber& number = numbers[j];
        const auto found = std::ranges::find(record.parameters, number.name, &skeleton::EffectParameter::name);
        const bool is_specified = found != record.parameters.end();
        result[j] = !is_specified ? number.start : number.logarithm ? std::log(found->value) : found->value;
    }
    return result;
}

MeasurementSet EffectHypothesis::corrected(const MeasurementSet& set, const skeleton::EffectRecord&) const {
    return set;
}

void EffectHypothesis::hide(const skeleton::EffectRecord& record, TrueConditions& conditions) const {
    conditions.setting.effects.add(skeleton::make_physics(record));
}

std::vector<skeleton::KnownParameter> EffectHypothesis::numbers_to_hide() const {
    return skeleton::find_known_effect(name())->parameters;
}

std::vector<EffectSampler> EffectHypothesis::samplers(SamplingContext&, const SpecifiedNumbers&) const { return {}; }

}  // namespace palpate::identify
