#include "identify/preflight/prospects/linear_point.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "identify/diagnosis/likelihood/reading_weights.h"
#include "identify/diagnosis/search/screen.h"
#include "identify/diagnosis/search/screen_plan.h"

namespace palpate::identify {
namespace {

Whitening with_columns(const Eigen::VectorXd& weights, const Nuisances& nuisances, const Eigen::MatrixXd& columns,
                       const Eigen::VectorXd& prior_sd) {
    Eigen::MatrixXd all(columns.rows(), columns.cols() + nuisances.columns.cols());
    all << columns, nuisances.columns;
    Eigen::VectorXd precisions(all.cols());
    precisions << prior_sd.cwiseAbs2().cwiseInverse(), nuisances.precisions;
    return {weights, all, precisions};
}

/// Weights of the readings (N) by what the model is off by: sigma^2 -> sigma^2 + (share u)^2, u the rms of what
/// the model shows of that kind in the state.
Eigen::VectorXd weights_of_mesh(const Problem& problem, const ForwardSolution& forward, double share) {
    Eigen::VectorXd read = problem.pick(forward.markers);
    for (Eigen::Index n = 0; n < read.size(); ++n) read[n] -= problem.origin(n);
    // Of a state's positions, or of its reactions: their sum, and how many there are.
    std::map<std::pair<int, bool>, std::pair<double, int>> squares;
    for (Eigen::Index n = 0; n < problem.rows(); ++n) {
        auto& [sum, count] = squares[{problem.state[n], problem.is_position(n)}];
        sum += read[n] * read[n];
        ++count;
    }
    Eigen::VectorXd weights(problem.rows());
    for (Eigen::Index n = 0; n < problem.rows(); ++n) {
        const auto& [sum, count] = squares[{problem.state[n], problem.is_position(n)}];
        const double off = share * std::sqrt(sum / count);
        weights[n] = problem.sigma[n] / std::hypot(problem.sigma[n], off);
    }
    return weights;
}

/// The point in a problem that tells all stages apart.
ForwardSolution forward_in_stages(const BodyModel& model, const LinearPoint& point, const Problem& merged,
                                  const Problem& stages) {
    Refit fit;
    fit.explanation = point.explanation;
    fit.forward = point.forward;
    return expand_to_stages(model, fit, merged, stages).forward;
}

}  // namespace

LinearPoint linearise(const BodyModel& model, const Problem& problem, const Explanation& explanation, double mesh_error,
                      int threads, const LinearPoint* known) {
    std::vector<Eigen::VectorXd> start(problem.actions.size());
    if (known) std::ranges::copy(known->forward.q, start.begin());
    ForwardSolution forward = solve_forward(model, problem, explanation, threads, &start);
    Eigen::MatrixXd columns = sensitivities(model, problem, explanation, forward,
                                            {own_signatures(model, problem, explanation, forward)}, threads)
                                  .front() +
                              seen_directly(model, problem, explanation, forward);
    Eigen::VectorXd prior_sd(std::ssize(model.parameters()));
    for (Eigen::Index p = 0; p < prior_sd.size(); ++p) prior_sd[p] = model.parameters()[p].prior_sd;
    Nuisances nuisances = make_nuisances(model, problem, explanation, forward, threads);
    const Eigen::VectorXd weights = reading_weights(model, problem, explanation, forward)
                                        .cwiseProduct(weights_of_mesh(problem, forward, mesh_error));
    Whitening rig(weights, nuisances.columns, nuisances.precisions);
    Whitening all = with_columns(weights, nuisances, columns, prior_sd);
    return {explanation,          std::move(forward), std::move(columns), std::move(prior_sd),
            std::move(nuisances), std::move(rig),     std::move(all)};
}

std::vector<EffectSignature> signatures_at(const BodyModel& model, const Problem& problem, const LinearPoint& point,
                                           const std::vector<std::shared_ptr<const EffectHypothesis>>& effects,
                                           int threads) {
    std::vector<EffectSignature> result;
    result.reserve(effects.size());
    for (const auto& effect : effects) result.push_back({effect, {}});
    // Effects with a memory ask stage by stage.
    const Problem stages = problem.by_stage ? problem : problem.stage_by_stage();
    const ForwardSolution in_stages =
        problem.by_stage ? point.forward : forward_in_stages(model, point, problem, stages);
    for (const bool memory : {false, true}) {
        const Problem& asked = memory ? stages : problem;
        const ForwardSolution& forward = memory ? in_stages : point.forward;
        std::vector<std::size_t> places;
        std::vector<ScreenPlan> plans;
        std::vector<Signatures> signatures;
        for (std::size_t e = 0; e < effects.size(); ++e) {
            if (effects[e]->has_memory() != memory || effects[e]->numbers(model, asked).empty()) continue;
            places.push_back(e);
            plans.push_back(screen_plan(*effects[e], model, asked, point.explanation, forward));
            signatures.push_back(plans.back().signatures);
        }
        if (plans.empty()) continue;
        const std::vector<Eigen::MatrixXd> answered =
            sensitivities(model, asked, point.explanation, forward, signatures, threads);
        for (std::size_t i = 0; i < plans.size(); ++i) result[places[i]].columns = plans[i].columns(answered[i]);
    }
    return result;
}

}  // namespace palpate::identify
