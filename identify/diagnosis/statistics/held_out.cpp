#include "identify/diagnosis/statistics/held_out.h"

#include <algorithm>
#include <cmath>

#include "identify/diagnosis/fit/measured_branch.h"
#include "identify/diagnosis/likelihood/reading_weights.h"
#include "identify/diagnosis/statistics/discretisation.h"
#include "identify/models/tool_path.h"
#include "identify/numerics/load_reduction.h"
#include "mesh/core/scaled_motion.h"
#include "mesh/errors.h"

namespace palpate::identify {

std::vector<int> held_out_groups(const Problem& problem) {
    std::vector<int> probe(problem.rows()), action(problem.rows());
    for (Eigen::Index n = 0; n < problem.rows(); ++n) {
        action[n] = problem.action[n];
        probe[n] = problem.probe[action[n]];
    }
    const bool is_one = std::ranges::all_of(probe, [&](int p) { return p == probe.front() || p == -1; });
    return is_one ? action : probe;
}

HeldOut leave_probes_out(const Problem& problem, const Refit& fit) {
    // All unknowns as one linear model about their priors' means: d + A (x - mean) = A x' + nuisances + noise.
    const Eigen::Index own = fit.columns.cols(), all = own + fit.nuisances.columns.cols();
    Eigen::MatrixXd A(problem.rows(), all);
    A << fit.columns, fit.nuisances.columns;
    Eigen::VectorXd precisions(all);
    precisions << fit.prior_sd.cwiseAbs2().cwiseInverse(), fit.nuisances.precisions;
    const Eigen::VectorXd d = fit.error + fit.columns * (fit.explanation.all() - fit.prior_mean);

    const std::vector<int> group = held_out_groups(problem);
    const LeftOutErrors left = leave_out(Whitening(fit.V->weights(), A, precisions), d, group);
    const auto N = static_cast<double>(problem.rows());
    const Eigen::VectorXd error = problem.sigma.cwiseProduct(left.error.col(0));
    return {problem.rms_mm(error), problem.rms_n(error), std::sqrt(left.chi_square[0] / N), {}};
}

namespace {

/// The fit's explanation in another problem, and how uncertain its numbers are there.
struct TransferredExplanation {
    Explanation explanation;
    Eigen::MatrixXd covariance;
};

TransferredExplanation carry(const BodyModel& model, const Problem& unseen, const Refit& fit) {
    TransferredExplanation result;
    result.explanation = {.law = fit.explanation.law, .theta = fit.explanation.theta, .effects = {}, .values = {}};
    std::vector<Eigen::Index> from;  // place in the fit of each number, -1: it is of these probes alone
    std::vector<double> prior_sd;
    for (Eigen::Index p = 0; p < fit.explanation.theta.size(); ++p) {
        from.push_back(p);
        prior_sd.push_back(fit.prior_sd[p]);
    }
    Eigen::Index at = fit.explanation.theta.size();
    for (std::size_t e = 0; e < fit.explanation.effects.size(); ++e) {
        const EffectHypothesis& effect = *fit.explanation.effects[e];
        const auto numbers = effect.numbers(model, unseen);
        if (!numbers.empty() || fit.numbers[e].empty()) {
            const skeleton::EffectRecord estimate = effect.record(fit.numbers[e], fit.explanation.values[e]);
            result.explanation.effects.push_back(fit.explanation.effects[e]);
            result.explanation.values.push_back(effect.values(numbers, estimate));
        }
        for (const EffectNumber& number : numbers) {
            const auto same = std::ranges::find(fit.numbers[e], number.name, &EffectNumber::name);
            from.push_back(same == fit.numbers[e].end() ? -1 : at + (same - fit.numbers[e].begin()));
            prior_sd.push_back(number.prior_sd);
        }
        at += std::ssize(fit.numbers[e]);
    }
    result.covariance.setZero(std::ssize(from), std::ssize(from));
    for (std::size_t i = 0; i < from.size(); ++i) {
        for (std::size_t j = 0; j < from.size(); ++j) {
            if (from[i] >= 0 && from[j] >= 0) result.covariance(i, j) = fit.covariance(from[i], from[j]);
        }
        if (from[i] < 0) result.covariance(i, i) = prior_sd[i] * prior_sd[i];
    }
    return result;
}

/// The problem with loads that the body bears: a fit that lacks an effect may be too soft for a probe that it has not
/// seen, and is as far off there as it can get.
Problem with_reduced_loads(const BodyModel& model, const Problem& problem, const Explanation& explanation) {
    const ModelSetting setting = explanation.setting();
    Problem eased = problem;
    for (int k = 0; k < static_cast<int>(eased.actions.size()); ++k) {
        Action& action = eased.actions[k];
        for (int reductions = 0; reductions < most_load_reductions; ++reductions) {
            if (has_equilibrium(model, setting, explanation.act(eased, k))) break;
            for (mesh::Contact& contact : action.contacts) contact.force *= load_reduction;
            if (k > 0 && eased.probe[k - 1] == eased.probe[k] && is_reached_from(eased.actions[k - 1], action))
                action = on_the_way(eased.actions[k - 1], action, load_reduction);
            else
                for (mesh::ToolMotion& motion : action.motions) motion = mesh::scaled(motion, load_reduction);
            for (mesh::ActuatorSetting& one : action.settings) one.scale(load_reduction);
        }
    }
    return eased;
}

}  // namespace

HeldOutPrediction predict_response(const BodyModel& model, const Problem& unseen, const Refit& fit,
                                   const RefitOptions& options) {
    HeldOutPrediction result;
    const bool in_stages = fit.explanation.has_memory() && !unseen.by_stage;
    result.problem = in_stages ? unseen.stage_by_stage() : unseen;
    TransferredExplanation carried = carry(model, result.problem, fit);
    result.explanation = std::move(carried.explanation);
    result.covariance = std::move(carried.covariance);
    try {
        result.forward = solve_forward(model, result.problem, result.explanation, options.threads);
    } catch (const SolverFailure&) {
        result.problem = with_reduced_loads(model, result.problem, result.explanation);
        result.forward = solve_forward(model, result.problem, result.explanation, options.threads);
    }
    return result;
}

HeldOut predict(const BodyModel& model, const Problem& merged, const Refit& fit, const RefitOptions& options) {
    auto [explanation, covariance, unseen, forward] = predict_response(model, merged, fit, options);
    // Which of several equilibria the body is in cannot be predicted, and is not what is judged.
    if (auto nearer = nearer_to_measured(model, unseen, explanation, forward, options.threads))
        forward = *std::move(nearer);
    if (options.correct_for_mesh)
        unseen.correct_for(discretisation_error(model, unseen, explanation, forward, options.threads));
    const Eigen::VectorXd error = (unseen.measured - unseen.pick(forward.markers)).cwiseQuotient(unseen.sigma);
    const Nuisances nuisances = make_nuisances(model, unseen, explanation, forward, options.threads, options.nuisances);
    const Eigen::MatrixXd own = sensitivities(model, unseen, explanation, forward,
                                              {own_signatures(model, unseen, explanation, forward)}, options.threads)
                                    .front() +
                                seen_directly(model, unseen, explanation, forward);

    const Eigen::MatrixXd spread = covariance.llt().matrixL();
    Eigen::MatrixXd A(unseen.rows(), own.cols() + nuisances.columns.cols());
    A << own * spread, nuisances.columns;
    Eigen::VectorXd precisions(A.cols());
    precisions << Eigen::VectorXd::Ones(own.cols()), nuisances.precisions;
    const Whitening V(reading_weights(model, unseen, explanation, forward, options.nuisances), A, precisions);
    const Eigen::VectorXd unscaled = error.cwiseProduct(unseen.sigma);
    return {unseen.rms_mm(unscaled), unseen.rms_n(unscaled), V.rms(error), V.residual(error)};
}

}  // namespace palpate::identify
