#include "identify/diagnosis/fit/descent.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "mesh/errors.h"

namespace palpate::identify {
namespace {

// A step that promises to lower half the chi^2 by less is none: nothing against an evidence of 1, or against what a fit
// that explains little is off by anyway. The less, the more effects leave; what they are sought at is to be exact.
double settled(double objective, Eigen::Index readings, bool has_effects) {
    const double noise = 0.5 * static_cast<double>(readings);
    constexpr double share = 1e-3;
    const double most = has_effects ? 20 * share : share;
    constexpr double least = 0.02;  // of ln of evidence
    return std::max(least, std::clamp(share * objective / noise, share, most) * (objective - noise));
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

}  // namespace

double objective(const Whitening& V, const Eigen::VectorXd& d, const FitPriors& priors, const Eigen::VectorXd& x) {
    return 0.5 * V.chi_square(d) + priors.objective(x);
}

Eigen::VectorXd error_of(const Problem& problem, const ForwardSolution& forward) {
    return (problem.measured - problem.pick(forward.markers)).cwiseQuotient(problem.sigma);
}

Descent::Descent(const BodyModel& model, const Problem& problem, const FitPriors& priors, const RefitOptions& options,
                 Refit& at)
    : model_(model),
      problem_(problem),
      priors_(priors),
      threads_(options.threads),
      rival_(std::max(1.0, options.rival)),
      at_(at) {}

void Descent::run(int most_steps, bool to_the_end) {
    int crawling = 0;
    double now = objective(*at_.V, at_.error, priors_, at_.explanation.all());
    linearise();
    // A fit that still decreases by a tenth per step is converging: it gets additional steps, up to a bound on its
    // price.
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
        constexpr double little = 0.01;  // of the objective; design choice: the second round goes to the end
        crawling = is_shortened_ && before - now < little * now ? crawling + 1 : 0;
        if (crawling == 2 && !to_the_end && at_.explanation.has_memory()) return;
    }
}

/// Behind its rival, and too slow to come near it?
bool Descent::cannot_catch_up(double now, double promised) const {
    constexpr int first_steps = 3;  // whose slopes are those of another place
    constexpr int many_steps = 6;
    const double rivals = 0.5 * rival_ * rival_ * static_cast<double>(problem_.rows());
    // Design choices, see RefitOptions::rival: with less fits are given up that would lead.
    constexpr double more = 3, behind = 1.5, far_behind = 5;  // times the promise; times the rival's rms
    const bool is_slow = at_.steps >= first_steps && now - more * promised > behind * behind * rivals;
    return is_slow || (at_.steps >= many_steps && now > far_behind * far_behind * rivals);
}

/// Plays a step, shortened until the objective falls. False when none was found.
bool Descent::advance(const Eigen::VectorXd& move, double& now) {
    const Eigen::VectorXd x = at_.explanation.all();
    const ModelSetting setting = at_.explanation.setting();
    constexpr double shorter = 0.4, shortest = 0.01;  // six attempts, each of which solves all actions
    for (double share = 1; share > shortest; share *= shorter) {
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

void Descent::linearise() {
    if (has_slopes_) return;
    at_.columns = sensitivities(model_, problem_, at_.explanation, at_.forward,
                                {own_signatures(model_, problem_, at_.explanation, at_.forward)}, threads_, &steps_)
                      .front() +
                  seen_directly(model_, problem_, at_.explanation, at_.forward);
    has_slopes_ = true;
}

}  // namespace palpate::identify
