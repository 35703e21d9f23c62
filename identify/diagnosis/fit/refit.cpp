#include "identify/diagnosis/fit/refit.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "identify/diagnosis/fit/fit_priors.h"
#include "identify/diagnosis/fit/known_magnitude.h"
#include "mesh/errors.h"

namespace palpate::identify {
namespace {

// A step that promises to lower half the chi^2 by less is none: nothing against an evidence of 1, or against what a fit
// that explains little is off by anyway. The less, the more effects leave; what they are sought at is to be exact.
double settled(double objective, Eigen::Index readings, bool has_effects) {
    const double noise = 0.5 * static_cast<double>(readings);
    constexpr double share = 1e-3;
    const double most = has_effects ? 20 * share : share;
    return std::max(0.02, std::clamp(share * objective / noise, share, most) * (objective - noise));
}

/// The move m that maximises g^T m - m^T H m / 2 where some numbers have theirs already.
Eigen::VectorXd best_move(Eigen::MatrixXd H, Eigen::VectorXd g, const std::map<Eigen::Index, double>& fixed) {
    for (const auto& [i, move] : fixed) g -= H.col(i) * move;
    for (const auto& [i, move] : fixed) {
        g[i] = move;
        H.row(i).setZero();
        H.col(i).setZero();
        H(i, i) = 1;
    }
    return H.llt().solve(g);
}

/// Numbers that stand at a bound and would go beyond it.
std::map<Eigen::Index, double> held_at_bounds(const Eigen::VectorXd& g, const FitPriors& priors,
                                              const Eigen::VectorXd& x) {
    std::map<Eigen::Index, double> fixed;
    for (Eigen::Index i = 0; i < x.size(); ++i) {
        const bool is_free = (x[i] > priors.least[i] || g[i] > 0) && (x[i] < priors.most[i] || g[i] < 0);
        if (!is_free) fixed[i] = 0;
    }
    return fixed;
}

/// A move of which no number goes further than it may at once. Numbers that are slack go as far as they may, and the
/// others take account of it; where one of these would go too far, all go less.
Eigen::VectorXd limited_move(const Eigen::MatrixXd& H, const Eigen::VectorXd& g, const FitPriors& priors,
                             std::map<Eigen::Index, double> fixed, Eigen::VectorXd move) {
    for (const Eigen::Index i : priors.weakly_identified) {
        if (std::abs(move[i]) <= priors.step[i]) continue;
        fixed[i] = std::copysign(priors.step[i], move[i]);
        move = best_move(H, g, fixed);
    }
    return move * std::min(1.0, 1 / move.cwiseQuotient(priors.step).cwiseAbs().maxCoeff());
}

/// Half of chi^2 and priors, to be lowered.
double objective(const Whitening& V, const Eigen::VectorXd& d, const FitPriors& priors, const Eigen::VectorXd& x) {
    return 0.5 * d.dot(V.apply(d).col(0)) + priors.objective(x);
}

Eigen::VectorXd error_of(const Problem& problem, const ForwardSolution& forward) {
    return (problem.measured - problem.pick(forward.markers)).cwiseQuotient(problem.sigma);
}

/// A fit in progress, at fixed V.
class Descent {
public:
    Descent(const BodyModel& model, const Problem& problem, const FitPriors& priors, const RefitOptions& options,
            Refit& at)
        : model_(model),
          problem_(problem),
          priors_(priors),
          threads_(options.threads),
          rival_(std::max(1.0, options.rival)),
          at_(at) {}

    /// `to_the_end`: else it may stop where it hardly gets on, as V is not the last one, and bodies with memory are
    /// slow to play.
    void run(int most_steps, bool to_the_end) {
        int crawling = 0;
        double now = objective(*at_.V, at_.error, priors_, at_.explanation.all());
        linearise();
        // A fit that still decreases by a tenth per step is converging: it gets additional steps.
        constexpr int at_most = 4;  // times as many
        constexpr double much = 0.1;
        bool falls = true;
        for (int step = 0; step < most_steps || (falls && step < at_most * most_steps); ++step) {
            const Eigen::MatrixXd VA = at_.V->apply(at_.columns);
            const Eigen::VectorXd x = at_.explanation.all();
            Eigen::MatrixXd H = at_.columns.transpose() * VA;
            H.diagonal() += priors_.precisions();
            const Eigen::VectorXd g = VA.transpose() * at_.error - priors_.slope(x);
            const std::map<Eigen::Index, double> held = held_at_bounds(g, priors_, x);
            const Eigen::VectorXd move = best_move(H, g, held);
            at_.covariance = H.llt().solve(Eigen::MatrixXd::Identity(x.size(), x.size()));
            at_.converged = 0.5 * g.dot(move) < settled(now, problem_.rows(), !at_.explanation.effects.empty());
            if (at_.converged || cannot_catch_up(now, 0.5 * g.dot(move))) return;
            ++at_.steps;
            const double before = now;
            if (!advance(limited_move(H, g, priors_, held, move), now)) return;
            falls = before - now > much * before && !at_.explanation.has_memory();
            linearise();
            constexpr double little = 0.01;
            crawling = is_shortened_ && before - now < little * now ? crawling + 1 : 0;
            if (crawling == 2 && !to_the_end && at_.explanation.has_memory()) return;
        }
    }

private:
    /// Behind its rival, and too slow to come near it?
    bool cannot_catch_up(double now, double promised) const {
        constexpr int first_steps = 3;  // whose slopes are those of another place
        constexpr int many_steps = 6;
        const double rivals = 0.5 * rival_ * rival_ * static_cast<double>(problem_.rows());
        const bool is_slow = at_.steps >= first_steps && now - 3 * promised > 1.5 * 1.5 * rivals;
        return is_slow || (at_.steps >= many_steps && now > 5 * 5 * rivals);
    }

    /// Plays a step, shortened until the objective falls. False when none was found.
    bool advance(const Eigen::VectorXd& move, double& now) {
        const Eigen::VectorXd x = at_.explanation.all();
        const ModelSetting setting = at_.explanation.setting();
        for (double share = 1; share > 0.01; share *= 0.4) {
            Explanation trial = at_.explanation;
            trial.set_all((x + share * move).cwiseMax(priors_.least).cwiseMin(priors_.most));
            std::vector<Eigen::VectorXd> predicted = at_.forward.q;
            for (std::size_t k = 0; k < predicted.size(); ++k) {
                if (steps_[k].size() > 0) {
                    predicted[k] = model_.advance(predicted[k], steps_[k] * (share * move), setting);
                }
            }
            try {
                ForwardSolution forward =
                    solve_forward(model_, problem_, trial, threads_, &predicted, at_.forward.tangents.get());
                const Eigen::VectorXd error = error_of(problem_, forward);
                const double then = objective(*at_.V, error, priors_, trial.all());
                if (!(then < now)) continue;
                now = then;
                is_shortened_ = share < 1;
                at_.explanation = std::move(trial);
                at_.forward = std::move(forward);
                at_.error = error;
                has_slopes_ = false;
                return true;
            } catch (const SolverFailure&) {
                continue;  // too soft to carry its load: no improvement
            }
        }
        return false;
    }

    void linearise() {
        if (has_slopes_) return;
        at_.columns = sensitivities(model_, problem_, at_.explanation, at_.forward,
                                    {own_signatures(model_, problem_, at_.explanation, at_.forward)}, threads_, &steps_)
                          .front() +
                      seen_directly(model_, problem_, at_.explanation, at_.forward);
        has_slopes_ = true;
    }

    const BodyModel& model_;
    const Problem& problem_;
    const FitPriors& priors_;
    int threads_;
    double rival_;  // whitened rms, at least that of noise
    Refit& at_;
    bool has_slopes_ = false;             // columns and steps are those of where it stands
    bool is_shortened_ = false;           // the last step went less far than it was meant to
    std::vector<Eigen::MatrixXd> steps_;  // J^-1 times the signatures, of each action
};

/// Equilibria at the start, from the neighbour's configurations, else from rest; where there are none the body is made
/// stiffer.
void begin(const BodyModel& model, const Problem& problem, int threads, const Refit* start, Refit& at) {
    const auto stands = [&](const std::vector<Eigen::VectorXd>* from) {
        at.forward = solve_forward(model, problem, at.explanation, threads, from);
        at.error = error_of(problem, at.forward);
    };
    // Configurations are the model's own, and another law may ask for others.
    const bool alike = start && start->forward.q.front().size() == model.rest(at.explanation.setting()).size();
    if (alike) {
        try {
            return stands(&start->forward.q);
        } catch (const SolverFailure&) {  // too far from there
        }
    }
    const int most = start ? 2 : 6;  // times
    for (int attempt = 0;; ++attempt) {
        try {
            return stands(nullptr);
        } catch (const SolverFailure&) {
            if (attempt == most) throw;
            for (Eigen::Index p = 0; p < at.explanation.theta.size(); ++p) {
                if (model.parameters()[p].stiffens) at.explanation.theta[p] += 0.3;
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

/// Covariance of the numbers by how far each probe pulls at them: C (sum_p s_p s_p^T) C P/(P - 1), s_p what the errors
/// of probe p that the nuisances do not explain add to the slope of the objective. Errors that the readings of a probe
/// share, as those of a mesh, show there, and not in C. [Liang & Zeger 1986; the "sandwich"]
Eigen::MatrixXd scatter_of_probes(const Problem& problem, const Refit& at) {
    const Eigen::VectorXd unexplained = at.residual.cwiseQuotient(at.V->weights());  // d - A nuisances
    const Eigen::MatrixXd slopes = at.V->apply(at.columns);
    std::map<int, Eigen::VectorXd> pulls;
    for (Eigen::Index n = 0; n < problem.rows(); ++n) {
        const auto [pull, is_new] = pulls.try_emplace(problem.probe[problem.action[n]]);
        if (is_new) pull->second.setZero(at.columns.cols());
        pull->second += unexplained[n] * slopes.row(n).transpose();
    }
    Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(at.columns.cols(), at.columns.cols());
    for (const auto& [probe, pull] : pulls) sum += pull * pull.transpose();
    const auto probes = static_cast<double>(pulls.size());
    return at.covariance * sum * at.covariance * (probes / std::max(probes - 1, 1.0));
}

/// How far the error of the mesh that was taken off the readings moves the numbers (p), as if all of it were left in.
Eigen::VectorXd shift_by_mesh(const Problem& problem, const FitPriors& priors, const Refit& at) {
    const Eigen::Index others = at.nuisances.columns.cols() - at.nuisances.of_mesh;
    const Whitening V(at.V->weights(), at.nuisances.columns.leftCols(others), at.nuisances.precisions.head(others));
    const Eigen::MatrixXd VA = V.apply(at.columns);
    Eigen::MatrixXd H = at.columns.transpose() * VA;
    H.diagonal() += priors.precisions();
    return H.llt().solve(VA.transpose() * problem.discretisation.cwiseQuotient(problem.sigma));
}

/// Covariance of the numbers beside that of the noise: as the probes disagree, and by the share of the mesh's error
/// that halved edges do not tell.
Eigen::MatrixXd scatter_of(const Problem& problem, const FitPriors& priors, const RefitOptions& options,
                           const Refit& at) {
    const Eigen::MatrixXd of_probes = scatter_of_probes(problem, at);
    if (at.nuisances.of_mesh == 0 || problem.discretisation.size() == 0) return of_probes;
    const Eigen::VectorXd shift = options.nuisances.discretisation * shift_by_mesh(problem, priors, at);
    return of_probes + shift * shift.transpose();
}

void conclude(const Problem& problem, const FitPriors& priors, const RefitOptions& options, Refit& at) {
    const auto N = static_cast<double>(problem.rows());
    const Eigen::VectorXd x = at.explanation.all();
    // ln Z = -(chi^2 + priors)/2 - ln |V| / 2 - sum ln sd + ln |covariance| / 2
    const Eigen::LLT<Eigen::MatrixXd> factor(at.covariance);
    at.log_evidence = -objective(*at.V, at.error, priors, x) - 0.5 * at.V->log_determinant() -
                      priors.sd.array().log().sum() + factor.matrixLLT().diagonal().array().log().sum();
    at.prior_mean = priors.mean;
    at.prior_sd = priors.sd;
    at.rms_mm = problem.rms_mm(at.error.cwiseProduct(problem.sigma));
    at.whitened_rms = std::sqrt(at.error.dot(at.V->apply(at.error).col(0)) / N);
    const Eigen::VectorXd nuisance_pulls = at.V->nuisances(at.error);
    if (nuisance_pulls.size() > 0) {
        Eigen::Index most = 0;
        at.nuisance_pull = nuisance_pulls.cwiseAbs().maxCoeff(&most);
        at.most_pulled_nuisance = at.nuisances.names[most];
    }
    at.residual = at.V->residual(at.error);
    at.scatter = scatter_of(problem, priors, options, at);
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
            conclude(problem, priors, options, with);
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
    constexpr double hopeless = 2;  // rms left, whitened
    const double left = std::sqrt(at.error.dot(at.V->apply(at.error).col(0)) / static_cast<double>(problem.rows()));
    if (!(start && start->V) || left < hopeless) {
        take_nuisances(model, problem, options, at);
        descent.run(options.steps, true);
    } else {
        at.nuisances = start->nuisances;
    }
    conclude(problem, priors, options, at);
    if (options.magnitude != MagnitudeUse::none) try_magnitude(model, problem, priors, options, at);
    at.forward.tangents.reset();  // many fits are kept
    return at;
}

Refit reassess(const BodyModel& model, const Problem& corrected, const RefitOptions& options, Refit fit) {
    fit.error = error_of(corrected, fit.forward);
    take_nuisances(model, corrected, options, fit);
    conclude(corrected, FitPriors(model, fit.explanation, fit.numbers), options, fit);
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
