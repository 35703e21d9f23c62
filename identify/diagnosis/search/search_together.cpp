// Several effects at once, and those that are asked where no other one explains the readings.

#include <algorithm>
#include <cmath>

#include "identify/diagnosis/search/search.h"
#include "identify/diagnosis/verdict/verdict.h"

namespace palpate::identify {
namespace {

std::vector<std::string> names_of(const FittedExplanation& explained) {
    std::vector<std::string> names;
    names.reserve(explained.effects.size());
    for (const auto& effect : explained.effects) names.push_back(effect->name());
    return names;
}

std::string listed(const std::vector<std::string>& names) {
    std::string text;
    for (const std::string& name : names) text += (text.empty() ? "" : " + ") + name;
    return text;
}

/// Evidence that an effect of a fit stands for, about: half the square of how far its best known number lies from where
/// it began, in standard deviations. [Savage-Dickey]
double evidence_for(const Refit& fit, const std::string& name) {
    Eigen::Index at = fit.explanation.theta.size();
    double most = 0;
    for (std::size_t e = 0; e < fit.explanation.effects.size(); ++e) {
        for (Eigen::Index j = 0; j < fit.explanation.values[e].size(); ++j, ++at) {
            if (fit.explanation.effects[e]->name() != name) continue;
            const double off = fit.explanation.values[e][j] - fit.prior_mean[at];
            most = std::max(most, 0.5 * off * off / fit.covariance(at, at));
        }
    }
    return most;
}

/// Half of the chi^2 that a fit leaves beyond noise.
double excess(const FittedExplanation& explained) {
    return 0.5 * static_cast<double>(explained.fit.error.size()) * (std::pow(explained.fit.whitened_rms, 2) - 1);
}

/// An explanation without one of its effects.
Explanation without(const Explanation& all, const std::string& name) {
    Explanation result = all;
    for (std::size_t e = 0; e < result.effects.size(); ++e) {
        if (result.effects[e]->name() != name) continue;
        result.effects.erase(result.effects.begin() + static_cast<std::ptrdiff_t>(e));
        result.values.erase(result.values.begin() + static_cast<std::ptrdiff_t>(e));
        break;
    }
    return result;
}

}  // namespace

/// Adds to what was tried the best effects next to one that is there; true where the evidence grew enough.
bool Search::extend(std::size_t from, int most) {
    const FittedExplanation base = tried_[from];
    const std::vector<std::string> there = names_of(base);
    report(progress_, "screen next to " + listed(there), 0.8);
    const bool noise_is_left =
        is_claimable(base, options_) && base.fit.whitened_rms <= options_.most_left(base.fit.error.size());
    const double leads = leader()->log_bayes_factor;
    bool grew = false;
    int refitted = 0;
    for (const ScreenedEffect& screened : screen_at(base.fit, there)) {
        if (refits_together_ >= options_.refits_together) break;
        if (base.log_bayes_factor + screened.at_most() < leads) continue;
        const double least = noise_is_left ? least_next_to_effect(*screened.effect, base, problem_, options_)
                                           : options_.least_evidence();
        // A screen is a linearisation, and says somewhat too little at times; little of much explains nothing.
        // Design choices, which save refits.
        constexpr double of_claim = 0.5, of_excess = 0.05;
        const double worth_a_fit = std::max({options_.least_evidence(), of_claim * least, of_excess * excess(base)});
        const bool said = refitted < most && screened.log_bayes_factor >= worth_a_fit;
        if (!said && !(screened.effect->evades_screen() && residual_is_small())) continue;
        std::vector<std::string> names = there;
        names.push_back(screened.effect->name());
        if (was_tried(names)) continue;
        report(progress_, "refit with " + listed(names), 0.85);
        ++refitted;
        ++refits_together_;
        auto found = refit_with(base.fit, screened);
        const bool worth = found && found->log_bayes_factor >= base.log_bayes_factor + least;
        if (!worth) {
            rejected_.push_back(names);
            continue;
        }
        found->effects.insert(found->effects.begin(), base.effects.begin(), base.effects.end());
        tried_.push_back(std::move(*found));
        grew = true;
    }
    return grew;
}

void Search::put_together() {
    if (options_.together < 2 || tried_.empty()) return;
    // The two single effects that explain most, then the best of what came out.
    const std::vector<std::size_t> order = by_evidence();
    const bool first_is_enough = leaves_only_noise(tried_[order.front()].fit, options_);
    for (std::size_t i = 0; i < std::min<std::size_t>(first_is_enough ? 1 : 2, order.size()); ++i) {
        if (!is_claimable(tried_[order[i]], options_)) break;
        extend(order[i], 3);
    }
    // One more is worth looking for where the last one has explained half of what was left: else it is not in the
    // catalogue.
    double left_with_fewer = excess(tried_[order.front()]);
    for (int count = 2; count < options_.together; ++count) {
        const std::size_t best = index_of_leader();
        if (std::ssize(tried_[best].effects) < count || leaves_only_noise(tried_[best].fit, options_)) break;
        const double left = excess(tried_[best]);
        if (left > 0.5 * left_with_fewer || !extend(best, 2)) break;
        left_with_fewer = left;
    }
    drop_and_swap();
}

void Search::drop_and_swap() {
    const FittedExplanation best = tried_[index_of_leader()];
    if (best.effects.size() < 2) return;
    for (const auto& effect : best.effects) {
        std::vector<std::string> rest = names_of(best);
        std::erase(rest, effect->name());
        const double own = evidence_for(best.fit, effect->name());
        constexpr double plenty = 10;  // times what a claim asks for: a fit without the effect hardly makes up for it
        const bool needed = own > plenty * options_.least_evidence();
        if (needed && leaves_only_noise(best.fit, options_)) continue;
        // Without an effect that says nothing the others explain as much from here, where their own fit did not get to.
        const bool is_idle = own < options_.least_evidence();
        if (was_tried(rest) && !is_idle) continue;
        if (refits_together_ >= options_.refits_together) break;
        ++refits_together_;
        // Drop: what is left may explain as much.
        report(progress_, "refit with " + listed(rest), 0.95);
        const Explanation explanation = without(best.fit.explanation, effect->name());
        std::vector<std::shared_ptr<const EffectHypothesis>> others = best.effects;
        std::erase(others, effect);
        const Refit* start = &best.fit;
        if (explanation.has_memory() != best.fit.explanation.has_memory()) {
            start = baselines_.under(explanation.law) ? &*baselines_.under(explanation.law) : &baselines_.best();
        }
        auto less = refit_from(explanation, *start, others);
        if (!less) continue;
        const bool is_new = !was_tried(rest);
        keep_better(std::move(*less));
        // Swap: another in its place.
        if (is_new && !leaves_only_noise(best.fit, options_)) extend(tried_.size() - 1, 1);
    }
    // What does as well with fewer effects stands for what has more.
    const std::size_t leader = index_of_leader();
    for (const FittedExplanation& fewer : std::vector<FittedExplanation>(tried_)) {
        const bool part =
            fewer.effects.size() < tried_[leader].effects.size() &&
            std::ranges::all_of(fewer.effects, [&](const auto& e) { return tried_[leader].has(e->name()); });
        if (part && tried_[leader].log_bayes_factor - fewer.log_bayes_factor < options_.least_evidence()) {
            tried_.erase(tried_.begin() + static_cast<std::ptrdiff_t>(leader));
            return;
        }
    }
}

void Search::last_resorts() {
    for (const auto& effect : effects_) {
        if (!effect->is_last_resort()) continue;
        // By itself, and next to what leads.
        std::vector<FittedExplanation> bases{{.effects = {}, .fit = baselines_.best()}};
        if (leader() && is_claimable(*leader(), options_)) bases.push_back(*leader());
        for (const FittedExplanation& base : bases) {
            const std::vector<ScreenedEffect> screened =
                screen_effects(model_, problem_for(base.fit.explanation), base.fit, {effect}, options_.refit.threads);
            if (screened.empty()) break;
            const bool is_alone = base.effects.empty();
            if (is_alone)
                ranking_.push_back({.effect = effect,
                                    .screened = screened[0].log_bayes_factor,
                                    .log_bayes_factor = screened[0].log_bayes_factor,
                                    .identifiable = screened[0].identifiable,
                                    .predicted_rms_mm = screened[0].predicted_rms_mm});
            if (screened[0].log_bayes_factor < options_.least_screen || could_explain_anything(base.fit, *effect))
                continue;
            report(progress_, "refit with " + effect->name(), 0.88);
            std::optional<FittedExplanation> found = refit_with(base.fit, screened[0]);
            if (!found || found->log_bayes_factor < base.log_bayes_factor + options_.least_evidence()) continue;
            found->effects.insert(found->effects.begin(), base.effects.begin(), base.effects.end());
            tried_.push_back(std::move(*found));
        }
    }
}

}  // namespace palpate::identify
