#include "identify/diagnosis/fit/refit.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "identify/diagnosis/fit/descent.h"
#include "identify/diagnosis/fit/measured_branch.h"
#include "identify/diagnosis/fit/priors/fit_priors.h"
#include "identify/diagnosis/fit/priors/known_magnitude.h"
#include "identify/diagnosis/fit/scatter.h"
#include "identify/diagnosis/likelihood/reading_weights.h"
#include "mesh/errors.h"

namespace palpate::identify {
namespace {

/// Takes equilibria that are much nearer to the measurements; false: there are none.
bool take_nearer_states(const BodyModel& model, const Problem& problem, int threads, Refit& at) {
    auto nearer = nearer_to_measured(model, problem, at.explanation, at.forward, threads);
    if (!nearer) return false;
    at.forward = *std::move(nearer);
    at.error = error_of(problem, at.forward);
    return true;
}

/// Equilibria at the start, from the neighbour's configurations, else from rest; where there are none the body is made
/// stiffer.
void begin(const BodyModel& model, const Problem& problem, int threads, const Refit* start, Refit& at) {
    const auto stands = [&](const std::vector<Eigen::VectorXd>* from) {
        at.forward = solve_forward(model, problem, at.explanation, threads, from);
        at.error = error_of(problem, at.forward);
        if (!from) take_nearer_states(model, problem, threads, at);
    };
    // Configurations are the model's own, and another law may ask for others.
    const bool alike = start && start->forward.q.front().size() == model.rest(at.explanation.setting()).size();
    if (alike) {
        try {
            return stands(&start->forward.q);
        } catch (const SolverFailure&) {  // too far from there
        }
    }
    constexpr double stiffer = 0.3;  // ln of the stiffness, each time: a third more
    const int most = start ? 2 : 6;  // times: to 1.8 or 6 times as stiff; a guess is further off than a fit nearby
    for (int attempt = 0;; ++attempt) {
        try {
            return stands(nullptr);
        } catch (const SolverFailure&) {
            if (attempt == most) throw;
            for (Eigen::Index p = 0; p < at.explanation.theta.size(); ++p) {
                if (model.parameters()[p].stiffens) at.explanation.theta[p] += stiffer;
            }
        }
    }
}

/// Readings weighed as an explanation has them, with nuisances that were taken there or nearby.
Whitening whitening_of(const BodyModel& model, const Problem& problem, const Explanation& explanation,
                       const ForwardSolution& forward, const RefitOptions& options, const Nuisances& nuisances) {
    return {reading_weights(model, problem, explanation, forward, options.nuisances), nuisances.columns,
            nuisances.precisions};
}

void take_nuisances(const BodyModel& model, const Problem& problem, const RefitOptions& options, Refit& at) {
    at.nuisances = make_nuisances(model, problem, at.explanation, at.forward, options.threads, options.nuisances);
    at.V = whitening_of(model, problem, at.explanation, at.forward, options, at.nuisances);
}

void conclude(const Problem& problem, const FitPriors& priors, Refit& at) {
    const Eigen::VectorXd x = at.explanation.all();
    // ln Z = -(chi^2 + priors)/2 - ln |V| / 2 - sum ln sd + ln |covariance| / 2
    const Eigen::LLT<Eigen::MatrixXd> factor(at.covariance);
    at.log_evidence = -objective(*at.V, at.error, priors, x) - 0.5 * at.V->log_determinant() -
                      priors.sd.array().log().sum() + factor.matrixLLT().diagonal().array().log().sum();
    at.prior_mean = priors.mean;
    at.prior_sd = priors.sd;
    const Eigen::VectorXd unscaled = at.error.cwiseProduct(problem.sigma);
    at.rms_mm = problem.rms_mm(unscaled);
    at.rms_n = problem.rms_n(unscaled);
    at.whitened_rms = at.V->rms(at.error);
    const Eigen::VectorXd nuisance_pulls = at.V->nuisances(at.error);
    if (nuisance_pulls.size() > 0) {
        Eigen::Index most = 0;
        at.nuisance_pull = nuisance_pulls.cwiseAbs().maxCoeff(&most);
        at.most_pulled_nuisance = at.nuisances.names[most];
    }
    at.residual = at.V->residual(at.error);
    at.scatter = scatter_of(problem, priors, at);
}

/// Where the numbers begin of an effect whose magnitude is known, and that; none: no effect has one.
std::optional<std::pair<Eigen::Index, MagnitudePrior>> magnitude_in(const Explanation& explanation) {
    Eigen::Index first = explanation.theta.size();
    for (std::size_t e = 0; e < explanation.effects.size(); ++e) {
        if (const auto known = explanation.effects[e]->magnitude()) return std::pair(first, *known);
        first += explanation.values[e].size();
    }
    return std::nullopt;
}

/// Moves a fit to where it has a known magnitude, if the evidence prefers that. Two hypotheses, equally likely before,
/// have the evidence ln((Z_1 + Z_2) / 2) together.
void try_magnitude(const BodyModel& model, const Problem& problem, const FitPriors& priors, const RefitOptions& options,
                   Refit& at) {
    const auto known = magnitude_in(at.explanation);
    if (!known) return;
    const Eigen::Index first = known->first;
    const Eigen::VectorXd x = at.explanation.all();
    const Eigen::MatrixXd C = at.covariance;
    const Mat3 own = C.block<3, 3>(first, first);
    const KnownMagnitude found =
        with_known_magnitude(x.segment<3>(first), own, priors.sd.segment<3>(first), known->second);
    const bool is_certain = options.magnitude == MagnitudeUse::certain;
    const double lead = found.log_bayes_factor;
    const double evidence =
        at.log_evidence +
        (is_certain ? lead : std::max(lead, 0.0) + std::log1p(std::exp(-std::abs(lead))) - std::numbers::ln2);
    if (is_certain || lead > 0) {
        // The other numbers follow, as they go with these.
        const Eigen::MatrixXd follow = C.middleCols<3>(first) * own.inverse();
        Refit with = at;
        with.explanation.set_all(
            (x + follow * (found.value - x.segment<3>(first))).cwiseMax(priors.least).cwiseMin(priors.most));
        try {
            with.forward = solve_forward(model, problem, with.explanation, options.threads, &at.forward.q);
            with.error = error_of(problem, with.forward);
            with.covariance += follow * (found.covariance - own) * follow.transpose();
            conclude(problem, priors, with);
            with.has_known_magnitude = true;
            at = std::move(with);
        } catch (const SolverFailure&) {  // it stays where it is
        }
    }
    at.log_evidence = evidence;
}

bool yields(const Explanation& explanation) { return explanation.setting().effects.plasticity.has_value(); }

/// The same effects under the same law, whatever their numbers.
bool is_like(const Explanation& a, const Explanation& b) { return a.law == b.law && a.effects == b.effects; }

}  // namespace

Refit refit(const BodyModel& model, const Problem& problem, const Explanation& explanation, const RefitOptions& options,
            const Refit* start) {
    Refit at;
    at.explanation = explanation;
    for (const auto& effect : explanation.effects) at.numbers.push_back(effect->numbers(model, problem));
    const FitPriors priors(model, explanation, at.numbers);
    begin(model, problem, options.threads, start, at);

    // A first round with the nuisances of the start, or none where it may be far; a second with those of where it led,
    // unless it led nowhere.
    if (start && start->V) {
        at.V = start->V;
        // What yields is trusted less, from the first step on.
        if (yields(explanation) && !yields(start->explanation)) {
            at.V = whitening_of(model, problem, at.explanation, at.forward, options, start->nuisances);
        }
    } else if (start && is_like(start->explanation, explanation)) {
        take_nuisances(model, problem, options, at);
    } else {
        at.V.emplace(reading_weights(model, problem, at.explanation, at.forward, options.nuisances),
                     Eigen::MatrixXd(problem.rows(), 0), Eigen::VectorXd(0));
    }
    Descent descent(model, problem, priors, options, at);
    descent.run(options.steps, false);
    // With other numbers there may be equilibria that there were not where it began.
    if (take_nearer_states(model, problem, options.threads, at)) {
        descent.states_replaced();
        descent.run(options.steps, false);
    }
    constexpr double hopeless = 2;  // rms left, whitened: a second round would hardly make it noise, and is saved
    if (!(start && start->V) || at.V->rms(at.error) < hopeless) {
        take_nuisances(model, problem, options, at);
        descent.run(options.steps, true);
    } else {
        at.nuisances = start->nuisances;
    }
    conclude(problem, priors, at);
    if (options.magnitude != MagnitudeUse::none) try_magnitude(model, problem, priors, options, at);
    at.forward.tangents.reset();  // many fits are kept
    return at;
}

Refit reassess(const BodyModel& model, const Problem& corrected, const RefitOptions& options, Refit fit) {
    fit.error = error_of(corrected, fit.forward);
    take_nuisances(model, corrected, options, fit);
    conclude(corrected, FitPriors(model, fit.explanation, fit.numbers), fit);
    fit.forward.tangents.reset();
    return fit;
}

Whitening with_numbers_unknown(const Refit& fit) {
    Eigen::MatrixXd columns(fit.error.size(), fit.nuisances.columns.cols() + fit.columns.cols());
    columns << fit.nuisances.columns, fit.columns;
    Eigen::VectorXd precisions(columns.cols());
    precisions << fit.nuisances.precisions, fit.prior_sd.cwiseAbs2().cwiseInverse();
    return {fit.V->weights(), columns, precisions};
}

double objective(const Refit& fit) {
    return objective(*fit.V, fit.error, FitPriors(fit.prior_mean, fit.prior_sd), fit.explanation.all());
}

double objective_near(const BodyModel& model, const Problem& problem, const Explanation& explanation,
                      const RefitOptions& options, const Refit& near) {
    std::vector<std::vector<EffectNumber>> numbers;
    for (const auto& effect : explanation.effects) numbers.push_back(effect->numbers(model, problem));
    try {
        const ForwardSolution forward = solve_forward(model, problem, explanation, options.threads, &near.forward.q);
        const FitPriors priors(model, explanation, numbers);
        const auto of = [&](const Whitening& V) {
            return objective(V, error_of(problem, forward), priors, explanation.all());
        };
        if (!yields(explanation) || yields(near.explanation)) return of(*near.V);
        const Whitening own = whitening_of(model, problem, explanation, forward, options, near.nuisances);
        return of(own) + 0.5 * (own.log_determinant() - near.V->log_determinant());
    } catch (const SolverFailure&) {
        return INFINITY;
    }
}

double promised_objective(const BodyModel& model, const Problem& problem, const Explanation& explanation,
                          const RefitOptions& options, const Refit& near) {
    try {
        const ForwardSolution forward = solve_forward(model, problem, explanation, options.threads, &near.forward.q);
        const Eigen::VectorXd d = error_of(problem, forward);
        const Eigen::VectorXd x = explanation.all();
        const FitPriors priors(near.prior_mean, near.prior_sd);
        const Eigen::VectorXd g = near.columns.transpose() * near.V->apply(d) - priors.slope(x);
        return objective(*near.V, d, priors, x) - 0.5 * g.dot(near.covariance * g);
    } catch (const SolverFailure&) {
        return INFINITY;
    }
}

}  // namespace palpate::identify
