// Several effects at once, and those that are asked where no other one explains the readings.

#include <algorithm>
#include <cmath>

#include "identify/diagnosis/search/search.h"
#include "identify/diagnosis/verdict/verdict.h"

namespace palpate::identify {
namespace {

constexpr int most_of_a_kind = 3;  // design choice: a map tells more than so many balls

std::string listed(const std::vector<std::string>& names) {
    std::string text;
    for (const std::string& name : names) text += (text.empty() ? "" : " + ") + name;
    return text;
}

/// Evidence that the effect at a place of a fit stands for, about: half the square of how far its best known number
/// lies from where it began, in standard deviations. [Savage-Dickey]
double evidence_for(const Refit& fit, std::ptrdiff_t place) {
    Eigen::Index at = fit.explanation.theta.size();
    double most = 0;
    for (std::size_t e = 0; e < fit.explanation.effects.size(); ++e) {
        for (Eigen::Index j = 0; j < fit.explanation.values[e].size(); ++j, ++at) {
            if (static_cast<std::ptrdiff_t>(e) != place) continue;
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

/// Where one of an explanation's effects is in its fit: behind those that are known.
std::ptrdiff_t place_in_fit(const FittedExplanation& explained, std::ptrdiff_t effect) {
    return std::ssize(explained.fit.explanation.effects) - std::ssize(explained.effects) + effect;
}

/// An explanation without the effect at a place.
Explanation without(const Explanation& all, std::ptrdiff_t place) {
    Explanation result = all;
    result.effects.erase(result.effects.begin() + place);
    result.values.erase(result.values.begin() + place);
    return result;
}

/// Does the last effect of a fit lie apart from all others of its kind? Else they are one of another shape.
bool last_lies_apart(const Explanation& all) {
    const std::size_t last = all.effects.size() - 1;
    for (std::size_t e = 0; e < last; ++e)
        if (all.effects[e] == all.effects[last] && !all.effects[last]->lie_apart(all.values[e], all.values[last]))
            return false;
    return true;
}

}  // namespace

/// Adds to what was tried the best effects next to one that is there; true where the evidence grew enough.
bool Search::extend(std::size_t from, int most) {
    const FittedExplanation base = tried_[from];
    const std::vector<std::string> there = base.names();
    report(progress_, "screen next to " + listed(there), 0.8);
    const bool noise_is_left =
        is_claimable(base, options_) && base.fit.whitened_rms <= options_.most_left(base.fit.error.size());
    const double leads = leader()->log_bayes_factor;
    bool grew = false;
    int refitted = 0;
    std::vector<std::string> not_again;
    for (const auto& effect : base.effects)
        if (!effect->may_repeat() || std::ranges::count(base.effects, effect) >= most_of_a_kind)
            not_again.push_back(effect->name());
    for (const ScreenedEffect& screened : screen_at(base.fit, not_again)) {
        if (refits_together_ >= options_.refits_together) break;
        if (base.log_bayes_factor + screened.at_most() < leads) continue;
        const double least = noise_is_left ? least_next_to_effect(base, options_) : options_.least_evidence();
        // A screen is a linearisation, which a refit may exceed severalfold where it says little; little of much
        // explains nothing. Design choices, which save refits.
        constexpr double of_claim = 0.25, of_excess = 0.05;
        // Once one is worth it, its rivals are fitted, too, before it is claimed.
        const double worth_a_fit =
            grew ? options_.least_evidence()
                 : std::max({options_.least_evidence(), of_claim * least, of_excess * excess(base)});
        const bool said = refitted < most && screened.log_bayes_factor >= worth_a_fit;
        if (!said && !(screened.effect->evades_screen() && residual_is_small())) continue;
        std::vector<std::string> names = there;
        names.push_back(screened.effect->name());
        if (was_tried(names)) continue;
        report(progress_, "refit with " + listed(names), 0.85);
        ++refitted;
        ++refits_together_;
        auto found = refit_with(base.fit, screened);
        const auto asked = [&] {
            if (!noise_is_left) return least;
            return least_next_to_effect(*found, base, problem_for(found->fit.explanation), options_);
        };
        const bool worth = found && found->log_bayes_factor >= base.log_bayes_factor + asked() &&
                           last_lies_apart(found->fit.explanation);
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
    for (std::ptrdiff_t e = 0; e < std::ssize(best.effects); ++e) {
        std::vector<std::shared_ptr<const EffectHypothesis>> others = best.effects;
        others.erase(others.begin() + e);
        std::vector<std::string> rest = best.names();
        rest.erase(rest.begin() + e);
        const std::ptrdiff_t place = place_in_fit(best, e);
        const double own = evidence_for(best.fit, place);
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
        const Explanation explanation = without(best.fit.explanation, place);
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
            std::ranges::all_of(fewer.effects, [&](const auto& e) {
                return std::ranges::count(fewer.effects, e) <= std::ranges::count(tried_[leader].effects, e);
            });
        if (part && tried_[leader].log_bayes_factor - fewer.log_bayes_factor < options_.least_evidence()) {
            tried_.erase(tried_.begin() + static_cast<std::ptrdiff_t>(leader));
            return;
        }
    }
}

/// Adds to what was tried further ones of its kinds that may repeat, as long as the evidence grows and more than noise
/// is left.
void Search::repeat(std::size_t from) {
    const auto count = [&](const std::shared_ptr<const EffectHypothesis>& effect) {
        return std::ranges::count(tried_[from].effects, effect);
    };
    // As many rounds: one that ends with as many as it began with has found better places for them.
    for (int round = 0; round < most_of_a_kind && !leaves_only_noise(tried_[from].fit, options_); ++round) {
        const FittedExplanation base = tried_[from];
        std::optional<FittedExplanation> best;
        for (const auto& effect : effects_) {
            if (!effect->may_repeat() || count(effect) == 0 || count(effect) >= most_of_a_kind) continue;
            if (could_explain_anything(base.fit, *effect)) continue;
            const std::vector<ScreenedEffect> screened =
                screen_effects(model_, problem_for(base.fit.explanation), base.fit, {effect}, options_.refit.threads);
            if (screened.empty() || screened[0].log_bayes_factor < options_.least_screen) continue;
            report(progress_, "refit with a further " + effect->name(), 0.87);
            std::optional<FittedExplanation> found = refit_with(base.fit, screened[0]);
            if (!found || (best && found->log_bayes_factor < best->log_bayes_factor)) continue;
            best = std::move(found);
        }
        if (!best || best->log_bayes_factor < base.log_bayes_factor + options_.least_evidence()) return;
        best->effects.insert(best->effects.begin(), base.effects.begin(), base.effects.end());
        tried_.push_back(std::move(*best));
        from = tried_.size() - 1;
        drop_one_of_a_kind(from);
    }
}

/// The first of several stood for all of them, and may be left for nothing: tries the others without each in turn.
/// What does as well without one stands for all of them.
void Search::drop_one_of_a_kind(std::size_t from) {
    const FittedExplanation all = tried_[from];
    std::optional<FittedExplanation> best;
    for (std::ptrdiff_t e = 0; e < std::ssize(all.effects); ++e) {
        const auto& effect = all.effects[static_cast<std::size_t>(e)];
        constexpr int least = 3;  // without one of two it is what one was found with
        if (!effect->may_repeat() || std::ranges::count(all.effects, effect) < least) continue;
        report(progress_, "refit with one " + effect->name() + " less", 0.87);
        std::vector<std::shared_ptr<const EffectHypothesis>> rest = all.effects;
        rest.erase(rest.begin() + e);
        std::optional<FittedExplanation> found =
            refit_from(without(all.fit.explanation, place_in_fit(all, e)), all.fit, rest);
        if (found && (!best || found->log_bayes_factor > best->log_bayes_factor)) best = std::move(found);
    }
    if (best && all.log_bayes_factor - best->log_bayes_factor < options_.least_evidence())
        tried_[from] = std::move(*best);
}

/// By itself, and next to what leads.
void Search::seek_last_resort(const std::shared_ptr<const EffectHypothesis>& effect) {
    std::vector<FittedExplanation> bases{{.effects = {}, .fit = baselines_.best()}};
    if (leader() && is_claimable(*leader(), options_)) bases.push_back(*leader());
    for (const FittedExplanation& base : bases) {
        const std::vector<ScreenedEffect> screened =
            screen_effects(model_, problem_for(base.fit.explanation), base.fit, {effect}, options_.refit.threads);
        if (screened.empty()) break;
        if (base.effects.empty())
            ranking_.push_back({.effect = effect,
                                .screened = screened[0].log_bayes_factor,
                                .log_bayes_factor = screened[0].log_bayes_factor,
                                .identifiable = screened[0].identifiable,
                                .predicted_rms_mm = screened[0].predicted_rms_mm});
        if (screened[0].log_bayes_factor < options_.least_screen || could_explain_anything(base.fit, *effect)) continue;
        report(progress_, "refit with " + effect->name(), 0.88);
        std::optional<FittedExplanation> found = refit_with(base.fit, screened[0]);
        if (!found || found->log_bayes_factor < base.log_bayes_factor + options_.least_evidence()) continue;
        found->effects.insert(found->effects.begin(), base.effects.begin(), base.effects.end());
        tried_.push_back(std::move(*found));
    }
}

void Search::last_resorts() {
    // Several of a kind: next to the best of them alone, and next to what leads with one.
    const auto may_repeat = [](const auto& effect) { return effect->may_repeat(); };
    const std::vector<std::size_t> order = by_evidence();
    const auto alone =
        std::ranges::find_if(order, [&](std::size_t i) { return std::ranges::all_of(tried_[i].effects, may_repeat); });
    if (alone != order.end()) repeat(*alone);
    if (!order.empty() && !(alone != order.end() && *alone == order[0]) &&
        std::ranges::any_of(tried_[order[0]].effects, may_repeat))
        repeat(order[0]);
    for (const auto& effect : effects_)
        if (effect->is_last_resort()) seek_last_resort(effect);
}

}  // namespace palpate::identify
