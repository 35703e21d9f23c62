#include "identify/diagnosis/search/search.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "identify/diagnosis/statistics/independent_readings.h"
#include "identify/diagnosis/statistics/largest_noise.h"
#include "identify/diagnosis/verdict/verdict.h"
#include "mesh/errors.h"

namespace palpate::identify {

Search::Search(const BodyModel& model, const Problem& problem, const Baselines& baselines,
               const std::vector<std::shared_ptr<const EffectHypothesis>>& effects, const DiagnoseOptions& options,
               const Progress& progress)
    : model_(model),
      problem_(problem),
      stages_(problem.by_stage ? problem : problem.stage_by_stage()),
      baselines_(baselines),
      effects_(effects),
      options_(options),
      progress_(progress),
      independent_(independent_readings(problem)) {}

void Search::single_effects() {
    screen_all();
    confirm_single_effects();
}

std::vector<Candidate> Search::ranking() const {
    std::vector<Candidate> result = ranking_;
    for (const FittedExplanation& single : tried_) {
        if (single.effects.size() > 1) continue;
        const auto own = std::ranges::find(result, single.effects.front(), &Candidate::effect);
        own->is_unfitted = false;
        own->objection.clear();
        own->log_bayes_factor = single.log_bayes_factor;
        own->refit = single.fit;
        own->held_out = single.held_out;
        own->estimate = single.estimate(own->effect->name());
    }
    std::ranges::stable_sort(result, std::greater{}, &Candidate::log_bayes_factor);
    return result;
}

const FittedExplanation* Search::leader() const { return tried_.empty() ? nullptr : &tried_[index_of_leader()]; }

std::size_t Search::index_of_leader() const {
    return static_cast<std::size_t>(std::ranges::max_element(tried_, {}, &FittedExplanation::log_bayes_factor) -
                                    tried_.begin());
}

std::vector<std::size_t> Search::by_evidence() const {
    std::vector<std::size_t> order(tried_.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::ranges::stable_sort(order, std::greater{}, [&](std::size_t i) { return tried_[i].log_bayes_factor; });
    return order;
}

const Problem& Search::problem_for(const Explanation& explanation) const {
    return explanation.has_memory() ? stages_ : problem_;
}

std::vector<ScreenedEffect> Search::screen_at(const Refit& base, const std::vector<std::string>& without) const {
    std::vector<std::shared_ptr<const EffectHypothesis>> others;
    std::ranges::copy_if(effects_, std::back_inserter(others), [&](const auto& effect) {
        return !effect->is_last_resort() && std::ranges::find(without, effect->name()) == without.end();
    });
    std::vector<ScreenedEffect> result =
        screen_effects(model_, problem_for(base.explanation), base, others, options_.refit.threads);
    std::ranges::stable_sort(result, std::greater{}, &ScreenedEffect::log_bayes_factor);
    return result;
}

void Search::refit_tried(const Problem& corrected) {
    problem_ = corrected;
    stages_ = problem_.by_stage ? problem_ : problem_.stage_by_stage();
    constexpr double of_leader = 0.5;  // what explains less will not lead by another correction; each costs a fit
    const double least = leader() ? of_leader * leader()->log_bayes_factor : 0;
    for (FittedExplanation& one : tried_) {
        report(progress_, "refit with a finer mesh's correction", 0.9);
        std::optional<FittedExplanation> found;
        if (one.log_bayes_factor >= least) {
            Refit start = one.fit;
            start.V.reset();
            found = refit_from(one.fit.explanation, start, one.effects);
        }
        if (found) {
            one = std::move(*found);
        } else {
            // Evidence to other readings does not compare.
            one.fit = reassess(model_, problem_for(one.fit.explanation), options_.refit, std::move(one.fit));
            one.log_bayes_factor = one.fit.log_evidence - baselines_.best().log_evidence;
        }
    }
}

void Search::screen_all() {
    screened_.assign(baselines_.laws(), {});
    // small strain, and the best of the laws of large deformation: they are alike
    int large = 1;
    for (int law = 2; law < baselines_.laws(); ++law) {
        if (baselines_.evidence(law) >= baselines_.evidence(large)) large = law;
    }
    for (const int law : {0, large}) {
        if (law >= baselines_.laws() || !baselines_.under(law)) continue;
        report(progress_, "screen, law " + model_.laws()[law], 0.4 + 0.05 * law);
        screened_[law] = screen_at(*baselines_.under(law), {});
    }
}

/// The law under which the best effect, by the screen, promises most.
int Search::most_promising_law() const {
    int best = 0;
    double most = -INFINITY;
    for (int law = 0; law < baselines_.laws(); ++law) {
        if (screened_[law].empty()) continue;
        const double more = std::max(0.0, screened_[law].front().log_bayes_factor);
        if (baselines_.evidence(law) + more > most) {
            most = baselines_.evidence(law) + more;
            best = law;
        }
    }
    return best;
}

/// A fit with one effect more; nothing where there is no equilibrium. Where it does not leave noise alone, another
/// place that promised nearly as much is tried too.
std::optional<FittedExplanation> Search::refit_with(const Refit& base, const ScreenedEffect& screened) const {
    Explanation explanation = base.explanation;
    explanation.effects.push_back(screened.effect);
    explanation.values.push_back(screened.starts.front());
    const bool spread = explanation.has_memory() && !base.explanation.has_memory() && !problem_.by_stage;
    const Refit from = spread ? expand_to_stages(model_, base, problem_, stages_) : base;
    explanation.values.back() = start_of(screened, objective(base), [&](const Eigen::VectorXd& start) {
        Explanation trial = explanation;
        trial.values.back() = start;
        return objective_near(model_, problem_for(trial), trial, options_.refit, from);
    });
    std::optional<FittedExplanation> found = refit_from(explanation, from, {screened.effect});
    const bool is_settled =
        found && found->fit.whitened_rms <= largest_noise(found->fit.error.size(), options_.false_refusals);
    if (!screened.elsewhere || is_settled) return found;
    explanation.values.back() = *screened.elsewhere;
    std::optional<FittedExplanation> other = refit_from(explanation, from, {screened.effect});
    return !found || (other && other->log_bayes_factor > found->log_bayes_factor) ? other : found;
}

std::optional<FittedExplanation> Search::refit_from(
    const Explanation& explanation, const Refit& start,
    const std::vector<std::shared_ptr<const EffectHypothesis>>& effects) const {
    try {
        const Problem& problem = problem_for(explanation);
        RefitOptions how = options_.refit;
        if (leader()) how.rival = leader()->fit.whitened_rms;
        FittedExplanation result{.effects = effects, .fit = refit(model_, problem, explanation, how, &start)};
        result.log_bayes_factor = result.fit.log_evidence - baselines_.best().log_evidence;
        result.held_out = leave_probes_out(problem, result.fit);
        return result;
    } catch (const SolverFailure&) {
        return std::nullopt;
    }
}

void Search::confirm_single_effects() {
    const int law = most_promising_law();
    if (screened_[law].empty()) return;
    const Refit& base = *baselines_.under(law);
    const bool enough = leaves_only_noise(baselines_.best(), options_);
    int refitted = 0;
    double claimed = -INFINITY;  // evidence of an effect that leaves nothing else to explain
    for (const ScreenedEffect& screened : screened_[law]) {
        Candidate candidate{.effect = screened.effect,
                            .screened = screened.log_bayes_factor,
                            .log_bayes_factor = screened.log_bayes_factor,
                            .identifiable = screened.identifiable,
                            .predicted_rms_mm = screened.predicted_rms_mm};
        // A refit finds more than a linearisation promises, and not many times as much: design choices, which save
        // refits.
        constexpr double of_leader = 0.1, of_claim = 0.3;
        double least = std::max(options_.least_screen, of_leader * screened_[law].front().log_bayes_factor);
        if (enough) least = std::max(least, of_claim * least_next_to_noise(options_));
        if (could_explain_anything(base, *screened.effect))
            candidate.objection = fmt::format(
                "with {} independent readings it would explain whatever was measured. Read more markers, or load other "
                "places",
                independent_);
        if (candidate.objection.empty() && refitted < options_.refits && screened.log_bayes_factor >= least &&
            screened.at_most() > claimed) {
            report(progress_, "refit with " + screened.effect->name(), 0.55 + 0.05 * refitted);
            if (auto found = refit_with(base, screened)) {
                if (claims(*found)) claimed = std::max(claimed, found->log_bayes_factor);
                tried_.push_back(std::move(*found));
            } else {
                candidate.is_unfitted = true;
                candidate.objection = "its fit found no equilibrium";
                candidate.log_bayes_factor += baselines_.evidence(law) - baselines_.best().log_evidence;
            }
            ++refitted;
        }
        ranking_.push_back(std::move(candidate));
    }
    for (const ScreenedEffect& screened : screened_[law]) {
        if (!screened.effect->evades_screen() || was_tried({screened.effect->name()})) continue;
        if (could_explain_anything(base, *screened.effect)) continue;
        if (!residual_is_small() && !is_confused_with_leader(*screened.effect)) continue;
        report(progress_, "refit with " + screened.effect->name(), 0.75);
        if (auto found = refit_with(base, screened)) tried_.push_back(std::move(*found));
    }
    confirm_at_load_response(law);
    // The law goes with the effect: the two that lead are tried under the others too.
    const std::vector<std::size_t> order = by_evidence();
    for (std::size_t i = 0; i < std::min<std::size_t>(2, order.size()); ++i) try_other_laws(order[i]);
    for (int other = 0; other < baselines_.laws(); ++other) {
        if (other != law && !screened_[other].empty()) confirm_under(other);
    }
    restart_leader();
}

/// Does it explain the readings, with nothing to be said against it?
bool Search::claims(const FittedExplanation& explained) const {
    if (!leaves_only_noise(explained.fit, options_) || !is_claimable(explained, options_)) return false;
    const bool is_noise = explained.effects.size() == 1 && leaves_only_noise(baselines_.best(), options_);
    const Explanation& all = explained.fit.explanation;
    if (is_noise && explained.log_bayes_factor < least_next_to_noise(explained, problem_for(all), options_))
        return false;
    for (std::size_t e = 0; e < all.effects.size(); ++e) {
        if (!explained.has(all.effects[e]->name())) continue;
        if (!all.effects[e]->objection(problem_, all.values[e]).empty()) return false;
    }
    return true;
}

/// Has it, with the stiffness, as many numbers as there are independent readings? No claim would come of its fit.
bool Search::could_explain_anything(const Refit& base, const EffectHypothesis& effect) const {
    return free_numbers(base) + effect.count_fitted(std::ssize(effect.numbers(model_, problem_))) >= independent_;
}

bool Search::has_claim() const {
    return std::ranges::any_of(tried_, [&](const FittedExplanation& one) { return claims(one); });
}

/// Something unexplained is left next to what leads, and not much of it.
bool Search::residual_is_small() const {
    constexpr double little = 2;  // rms, whitened: where more is left, something else is missing
    const Refit& leads = tried_.empty() ? baselines_.best() : leader()->fit;
    const bool nothing_is = tried_.empty() && leaves_only_noise(leads, options_);
    return !nothing_is && !has_claim() && leads.whitened_rms < little;
}

/// Does an effect claim that is taken for another one at times?
bool Search::is_confused_with_leader(const EffectHypothesis& other) const {
    if (!has_claim()) return false;
    const auto& aliases = leader()->effects.front()->description().confused_with;
    return std::ranges::find(aliases, other.name()) != aliases.end();
}

bool Search::was_tried(const std::vector<std::string>& names) const {
    const auto same = [&](const std::vector<std::string>& rejected) {
        return std::ranges::is_permutation(rejected, names);
    };
    return std::ranges::any_of(rejected_, same) || std::ranges::any_of(tried_, [&](const FittedExplanation& one) {
               return std::ranges::is_permutation(one.names(), names);
           });
}

}  // namespace palpate::identify
