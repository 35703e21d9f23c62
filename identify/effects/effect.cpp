#include "identify/effects/effect.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "identify/diagnose/fit.h"

namespace palpate::identify {

bool Effect::enforce(const Eigen::VectorXd&, Setting&) const { return false; }

Action Effect::act(const Problem&, int, Action action, const Eigen::VectorXd&) const { return action; }

Eigen::VectorXd Effect::in(const Circumstances&, const Eigen::VectorXd& values) const { return values; }

Points Effect::see(const Problem&, const Points& markers, const Eigen::VectorXd&) const { return markers; }

ScreenPlan Effect::screen_plan(const BodyModel& model, const Problem& problem, const Explanation& explanation,
                               const Played& played) const {
    const std::vector<EffectNumber> own = numbers(model, problem);
    Explanation with = explanation;
    with.effects.push_back(std::shared_ptr<const Effect>(std::shared_ptr<void>(), this));
    Eigen::VectorXd start(std::ssize(own)), prior_sd(std::ssize(own));
    for (std::size_t j = 0; j < own.size(); ++j) {
        start[static_cast<Eigen::Index>(j)] = own[j].start;
        prior_sd[static_cast<Eigen::Index>(j)] = own[j].prior_sd;
    }
    with.values.push_back(start);

    // Forces of its own numbers only, and what they change of what is seen.
    const Eigen::Index count = std::ssize(own);
    ScreenPlan plan;
    plan.signatures = {count, [&model, &problem, with, &played](int k, const Eigen::VectorXd& q) {
                           return signatures_of_last_effect(model, problem, with, played, k, q);
                       }};
    plan.columns = [&problem, with, &played, prior_sd, count](const Eigen::MatrixXd& answers) {
        return ScreenColumns{answers + seen_directly(problem, with, played).rightCols(count), prior_sd};
    };
    plan.start = [start](Eigen::Index, const Eigen::VectorXd&) { return start; };
    return plan;
}

std::string Effect::objection(const Problem&, const Eigen::VectorXd&, bool) const { return {}; }

skeleton::Effect Effect::told(const std::vector<EffectNumber>& numbers, const Eigen::VectorXd& values) const {
    assert(std::ssize(numbers) == values.size());
    skeleton::Effect result{name(), {}};
    for (std::size_t j = 0; j < numbers.size(); ++j) {
        const double value = values[static_cast<Eigen::Index>(j)];
        result.parameters.push_back({numbers[j].name, numbers[j].logarithm ? std::exp(value) : value, numbers[j].unit});
    }
    return result;
}

Eigen::VectorXd Effect::values(const std::vector<EffectNumber>& numbers, const skeleton::Effect& told) const {
    Eigen::VectorXd result(std::ssize(numbers));
    for (Eigen::Index j = 0; j < result.size(); ++j) {
        const EffectNumber& number = numbers[j];
        const auto found = std::ranges::find(told.parameters, number.name, &skeleton::EffectParameter::name);
        const bool is_told = found != told.parameters.end();
        result[j] = !is_told ? number.start : number.logarithm ? std::log(found->value) : found->value;
    }
    return result;
}

MeasurementSet Effect::corrected(const MeasurementSet& set, const skeleton::Effect&) const { return set; }

void Effect::hide(const skeleton::Effect& told, World& world) const {
    world.setting.effects.add(skeleton::make_physics(told));
}

std::vector<skeleton::KnownParameter> Effect::numbers_to_hide() const {
    return skeleton::find_known_effect(name())->parameters;
}

std::vector<Draft> Effect::drafts(Drawing&, const ToldNumbers&) const { return {}; }

}  // namespace palpate::identify
