#include "identify/diagnosis/fit/priors/fit_priors.h"

#include <algorithm>
#include <cmath>

namespace palpate::identify {

FitPriors::FitPriors(const BodyModel& model, const Explanation& explanation,
                     const std::vector<std::vector<EffectNumber>>& numbers) {
    const Eigen::VectorXd start = explanation.all();
    constexpr double factor_of_two = 0.7;
    const auto n = start.size();
    for (Eigen::VectorXd* column : {&mean, &sd, &least, &most, &step}) column->resize(n);
    Eigen::Index i = 0;
    for (const StiffnessParameter& p : model.parameters()) {
        mean[i] = p.prior_mean;
        sd[i] = p.prior_sd;
        least[i] = p.least;
        most[i] = p.most;
        step[i++] = std::min(p.prior_sd, factor_of_two);
    }
    for (const auto& list : numbers) {
        for (const EffectNumber& number : list) {
            if (number.weakly_identified) weakly_identified.push_back(i);
            mean[i] = number.prior_at_start ? start[i] : number.prior_mean;
            sd[i] = number.prior_sd;
            least[i] = number.least;
            most[i] = INFINITY;
            step[i++] = number.logarithm ? std::min(number.prior_sd, factor_of_two) : number.prior_sd;
        }
    }
}

}  // namespace palpate::identify
