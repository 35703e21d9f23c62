#include "identify/diagnosis/statistics/discretisation.h"

#include <algorithm>
#include <map>

#include "identify/numerics/parallel.h"
#include "mesh/errors.h"

namespace palpate::identify {

Eigen::VectorXd discretisation_error(const BodyModel& model, const Problem& problem, const Explanation& explanation,
                                     const ForwardSolution& forward, int threads) {
    const ModelSetting setting = explanation.setting();
    const auto count = static_cast<int>(problem.actions.size());
    // What could not be told elsewhere, or is none as nothing acts, is not tried again: it takes longest.
    std::vector<char> is_worth(count, problem.discretisation.size() == 0);
    for (Eigen::Index n = 0; n < problem.discretisation.size(); ++n)
        if (problem.discretisation[n] != 0) is_worth[problem.action[n]] = 1;
    std::vector<std::optional<Points>> seen(count);  // by how much the markers are seen elsewhere
    for_each_in_parallel(count, threads, [&](int k) {
        if (!is_worth[k]) return;
        const Action& action = forward.actions[k];
        try {
            const auto tangent = model.tangent(forward.q[k], setting, action);
            const std::optional<Points> error = model.discretisation_error(forward.q[k], setting, action, *tangent);
            if (error) seen[k] = explanation.see(problem, forward.stand[k] + *error) - forward.markers[k];
        } catch (const SolverFailure&) {  // on the verge of buckling: not told
        }
    });
    if (std::ranges::none_of(seen, [](const auto& one) { return one.has_value(); })) return problem.discretisation;
    Eigen::VectorXd result = Eigen::VectorXd::Zero(problem.rows());
    if (problem.discretisation.size() > 0) result = problem.discretisation;
    for (Eigen::Index n = 0; n < problem.rows(); ++n) {
        const auto& own = seen[problem.action[n]];
        if (own) result[n] = (*own)(problem.coordinate[n] / 3, problem.coordinate[n] % 3);
    }
    return result;
}

Eigen::VectorXd discretisation_of(const Problem& known, const Problem& problem) {
    if (known.discretisation.size() == 0) return {};
    std::map<std::pair<int, int>, double> errors;  // of actions and coordinates
    for (Eigen::Index n = 0; n < known.rows(); ++n)
        errors[{known.action[n], known.coordinate[n]}] = known.discretisation[n];
    std::vector<int> like(problem.actions.size());
    for (int k = 0; k < static_cast<int>(like.size()); ++k) like[k] = problem.action_in(known, k);
    Eigen::VectorXd result(problem.rows());
    for (Eigen::Index n = 0; n < problem.rows(); ++n) {
        const auto found = errors.find({like[problem.action[n]], problem.coordinate[n]});
        if (found == errors.end()) return {};
        result[n] = found->second;
    }
    return result;
}

}  // namespace palpate::identify
