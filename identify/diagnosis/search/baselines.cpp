#include "identify/diagnosis/search/baselines.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "identify/effects/catalogue.h"
#include "mesh/errors.h"

namespace palpate::identify {

Explanation Baselines::start(const Problem& problem, int law, const Eigen::VectorXd& theta) const {
    Explanation result{.law = law, .theta = theta, .effects = {}, .values = {}};
    for (const skeleton::EffectRecord& known : options_->known) {
        const auto effect = find_effect(known.name);
        const auto numbers = effect->numbers(*model_, problem);
        if (numbers.empty()) continue;
        result.effects.push_back(effect);
        result.values.push_back(effect->values(numbers, known));
    }
    return result;
}

/// `neighbour`: the fit under another law of large deformation, from where it is not far.
Refit Baselines::fit_under(const Problem& problem, int law, const Refit* neighbour) const {
    RefitOptions how = options_->refit;
    if (neighbour) {
        constexpr int from_near = 4;  // steps: few are enough from close by; design choice
        how.steps = std::min(how.steps, from_near);
        Refit from = *neighbour;
        from.V.reset();
        return identify::refit(*model_, problem, start(problem, law, from.explanation.theta), how, &from);
    }
    if (options_->near && options_->near->fit->explanation.law == law) {
        const std::optional<Refit> from = start_at(*options_->near, problem);
        const Explanation first = start(problem, law, options_->near->fit->explanation.theta);
        try {
            return identify::refit(*model_, problem, first, how, from ? &*from : nullptr);
        } catch (const SolverFailure&) {  // too soft without the effects that it has there
        }
    }
    return identify::refit(*model_, problem, start(problem, law, first_guess(*model_, problem, law, how.threads).theta),
                           how);
}

/// Could a law do about as well as a fit under another one? By its equilibria at the same numbers, and what a change of
/// them would mend by the slopes of the fit.
bool Baselines::could_match(const Problem& problem, int law, const Refit& fit) const {
    Explanation explanation = fit.explanation;
    explanation.law = law;
    const double promised = promised_objective(*model_, problem, explanation, options_->refit, fit);
    // ln of evidence, in units of what is left. Design choice: with more, laws are fitted that do not lead; with less,
    // one is missed whose nuisances, taken where it stands, would make up for what it lags by.
    constexpr double about = 50;
    return promised < objective(fit) + about * std::max(1.0, fit.whitened_rms * fit.whitened_rms);
}

/// The linear law first, as it is quick, unless tools or cables make it no quicker than the others; of these the last,
/// which is the best behaved.
std::vector<int> Baselines::order() const {
    std::vector<int> order;
    for (int law = laws() - 1; law > 0; --law) order.push_back(law);
    const Eigen::VectorXd theta = Eigen::VectorXd::Zero(std::ssize(model_->parameters()));
    const bool is_quick = !model_->is_nonlinear({0, theta, {}});
    order.insert(is_quick ? order.begin() : order.end(), 0);
    return order;
}

void Baselines::fit(const Problem& problem, std::vector<std::string>& notes, const Progress& progress) {
    std::string failure;
    std::ranges::fill(fits_, std::nullopt);
    large_deformation_failed_ = false;
    std::optional<Refit> neighbour;  // of another law of large deformation
    for (const int law : order()) {
        if (options_->law && *options_->law != law) continue;
        // Where more than this is left, whitened, other things matter than which of the laws of large deformation it
        // is.
        constexpr double much = 3;
        if (neighbour && neighbour->whitened_rms > much) continue;
        const std::string& name = model_->laws()[law];
        report(progress, "baseline, law " + name, 0.1);
        if (neighbour && !could_match(problem, law, *neighbour)) continue;
        try {
            fits_[law] = fit_under(problem, law, neighbour ? &*neighbour : nullptr);
            if (law > 0) neighbour = fits_[law];
        } catch (const SolverFailure& e) {
            failure = e.what();
            large_deformation_failed_ |= law > 0 && !options_->law;
            notes.push_back(fmt::format("Under the law {} the body has no equilibrium: {}", name, failure));
        }
    }
    large_deformation_failed_ &= !neighbour;
    if (std::ranges::none_of(fits_, [](const auto& found) { return found.has_value(); })) {
        throw SolverFailure("no law finds an equilibrium in every state: " + failure);
    }
}

void Baselines::refit(const Problem& problem, bool best_only) {
    const Refit* leading = &best();
    std::string failure;
    for (std::optional<Refit>& found : fits_) {
        if (!found || (best_only && &*found != leading)) continue;
        try {
            // from where it stands; the nuisances are made anew
            found->V.reset();
            found = identify::refit(*model_, problem, found->explanation, options_->refit, &*found);
        } catch (const SolverFailure& e) {
            failure = e.what();
            found.reset();
        }
    }
    if (std::ranges::none_of(fits_, [](const auto& found) { return found.has_value(); }))
        throw SolverFailure("no law can be fitted once more: " + failure);
}

const Refit& Baselines::best() const {
    int best = 0;
    for (int law = 1; law < laws(); ++law) {
        if (evidence(law) > evidence(best)) best = law;
    }
    return *fits_[best];
}

namespace {

/// In small strain, which is quick; but a skeleton's linear law knows no tools that may part from it, and a body's
/// bears none that press deep.
ForwardSolution roughly_solved(const BodyModel& model, const Problem& problem, Explanation explanation, int threads) {
    explanation.law = 0;
    try {
        return solve_forward(model, problem, explanation, threads);
    } catch (const SolverFailure&) {
        explanation.law = static_cast<int>(model.laws().size()) - 1;
        return solve_forward(model, problem, explanation, threads);
    }
}

}  // namespace

Explanation first_guess(const BodyModel& model, const Problem& problem, int law, int threads) {
    Explanation guess;
    guess.law = law;
    guess.theta.resize(std::ssize(model.parameters()));
    for (Eigen::Index p = 0; p < guess.theta.size(); ++p) guess.theta[p] = model.parameters()[p].start;

    // Linear answers against measurements, both less the unloaded pose where there is one: what acts without load
    // (weight, a moved frame) drops out.
    const ForwardSolution forward = roughly_solved(model, problem, guess, threads);
    const Eigen::VectorXd measured = problem.displacement();
    Eigen::VectorXd modelled = problem.pick(forward.markers);
    std::vector<double> sum(problem.rest.size(), 0.0);
    std::vector<int> count(problem.rest.size(), 0);
    for (Eigen::Index n = 0; n < problem.rows(); ++n) {
        modelled[n] -= problem.origin(n);
        if (problem.loaded(problem.action[n])) continue;
        sum[problem.coordinate[n]] += measured[n];
        ++count[problem.coordinate[n]];
    }
    // A force moves a stiffer body less; a tool that is moved feels more of it.
    struct Sums {
        double pm = 0, pp = 0;
    } compliance, stiffness;
    for (Eigen::Index n = 0; n < problem.rows(); ++n) {
        const int c = problem.coordinate[n];
        const Action& action = problem.actions[problem.action[n]];
        if (!is_loaded(action) || (problem.is_position(n) && !action.motions.empty())) continue;
        const double unloaded = count[c] > 0 ? sum[c] / count[c] : 0;
        const double w = 1 / (problem.sigma[n] * problem.sigma[n]);
        Sums& sums = problem.is_position(n) ? compliance : stiffness;
        sums.pm += w * modelled[n] * (measured[n] - unloaded);
        sums.pp += w * modelled[n] * modelled[n];
    }
    // Below a fiftieth the answers hardly go with the linear ones, or against them, and tell no scale.
    constexpr double least = 0.02;
    const auto ratio = [](const Sums& sums) {
        return sums.pp > 0 && sums.pm > least * sums.pp ? sums.pm / sums.pp : 1.0;
    };
    const double stiffer = stiffness.pp > 0 ? ratio(stiffness) : 1 / ratio(compliance);
    for (Eigen::Index p = 0; p < guess.theta.size(); ++p) {
        if (model.parameters()[p].stiffens) guess.theta[p] += std::log(stiffer);
    }
    return guess;
}

}  // namespace palpate::identify
