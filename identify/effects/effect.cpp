#include "identify/effects/effect.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "identify/diagnose/fit.h"

namespace palpate::identify {

std::shared_ptr<const fem::PointPotential> Effect::potential(const Eigen::VectorXd&) const { return nullptr; }

Action Effect::act(const Problem&, int, Action action, const Eigen::VectorXd&) const { return action; }

Points Effect::see(const Problem&, const Points& markers, const Eigen::VectorXd&) const { return markers; }

Eigen::MatrixXd Effect::force(const BodyModel& model, const Problem&, const Setting&, int, const Eigen::VectorXd&,
                              const Eigen::VectorXd& values) const {
    return Eigen::MatrixXd::Zero(model.dofs(), values.size());
}

Effect::ScreenColumns Effect::screen_columns(const BodyModel& model, const Problem& problem,
                                             const Explanation& explanation, const Played& played, int threads) const {
    // The signature of the numbers at their neutral start, as if they were in force.
    const std::vector<EffectNumber> own = numbers(model, problem);
    Explanation with = explanation;
    with.effects.push_back(std::shared_ptr<const Effect>(std::shared_ptr<void>(), this));
    Eigen::VectorXd start(std::ssize(own)), prior_sd(std::ssize(own));
    for (std::size_t j = 0; j < own.size(); ++j) {
        start[static_cast<Eigen::Index>(j)] = own[j].start;
        prior_sd[static_cast<Eigen::Index>(j)] = own[j].prior_sd;
    }
    with.values.push_back(start);
    const Eigen::MatrixXd all =
        answers(model, problem, with, played, {own_signatures(model, problem, with)}, threads).front() +
        seen_directly(problem, with, played);
    return {all.rightCols(std::ssize(own)), prior_sd};
}

Eigen::VectorXd Effect::start_after_screen(const ScreenColumns&, const Eigen::VectorXd& screened) const {
    return Eigen::VectorXd::Zero(screened.size());
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

}  // namespace palpate::identify
