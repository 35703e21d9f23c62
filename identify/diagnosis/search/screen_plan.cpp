#include "identify/diagnosis/search/screen_plan.h"

namespace palpate::identify {

ScreenPlan screen_plan_by_numbers(const EffectHypothesis& effect, const BodyModel& model, const Problem& problem,
                                  const Explanation& explanation, const ForwardSolution& forward) {
    const std::vector<EffectNumber> own = effect.numbers(model, problem);
    Explanation with = explanation;
    with.effects.push_back(std::shared_ptr<const EffectHypothesis>(std::shared_ptr<void>(), &effect));
    Eigen::VectorXd start(std::ssize(own)), prior_sd(std::ssize(own));
    for (std::size_t j = 0; j < own.size(); ++j) {
        start[static_cast<Eigen::Index>(j)] = own[j].start;
        prior_sd[static_cast<Eigen::Index>(j)] = own[j].prior_sd;
    }
    with.values.push_back(start);

    // Forces of its own numbers only, and what they change of what is seen.
    const Eigen::Index count = std::ssize(own);
    ScreenPlan plan;
    plan.signatures = {count, [&model, &problem, with, &forward](int k, const Eigen::VectorXd& q) {
                           return signatures_of_last_effect(model, problem, with, forward, k, q);
                       }};
    plan.columns = [&model, &problem, with, &forward, prior_sd, count](const Eigen::MatrixXd& sensitivities) {
        return ScreenColumns{sensitivities + seen_directly(model, problem, with, forward).rightCols(count), prior_sd};
    };
    plan.start = [start](Eigen::Index, const Eigen::VectorXd&) { return start; };
    return plan;
}

ScreenPlan screen_plan(const EffectHypothesis& effect, const BodyModel& model, const Problem& problem,
                       const Explanation& explanation, const ForwardSolution& forward) {
    if (auto own = effect.screen_plan(model, problem, explanation, forward)) return std::move(*own);
    return screen_plan_by_numbers(effect, model, problem, explanation, forward);
}

}  // namespace palpate::identify
