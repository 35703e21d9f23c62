// Other laws of the material, and other starts, than the screen led to.

#include "identify/diagnosis/search/search.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "identify/diagnosis/verdict/verdict.h"
#include "mesh/errors.h"

namespace palpate::identify {

/// A strong effect lies far from where the screen's linearisation holds, which may have led it to the wrong law. A
/// leader that leaves far more than noise goes on where its steps ended, and is fitted anew under the other laws,
/// whatever the screen promised there.
void Search::restart_leader() {
    constexpr double much = 2;  // whitened rms: where less is left, a second effect may account for it
    const auto leaves_much = [&] { return leader() && leader()->fit.whitened_rms >= much; };
    if (leaves_much() && !leader()->fit.converged) {
        const FittedExplanation single = *leader();
        report(progress_, "refit with " + single.effects.front()->name(), 0.78);
        if (auto found = carry_over(single, single.fit.explanation.law)) keep_better(std::move(*found));
    }
    if (!leaves_much()) return;
    const std::size_t leads = index_of_leader();
    const int own = tried_[leads].fit.explanation.law;
    for (int law = 0; law < baselines_.laws(); ++law) {
        if (law == own || screened_[law].empty()) continue;
        report(progress_,
               fmt::format("restart with {}, law {}", tried_[leads].effects.front()->name(), model_.laws()[law]), 0.78);
        std::optional<FittedExplanation> found = carry_over(tried_[leads], law);
        if (found) keep_better(std::move(*found));
    }
}

/// Where nothing explains the readings under the law that promised most, something may under this one: what leads its
/// screen, and what evades it.
void Search::confirm_under(int law) {
    constexpr int most_refits = 2;  // of what leads its screen: the price of another law
    const Refit& base = *baselines_.under(law);
    const double behind = baselines_.best().log_evidence - baselines_.evidence(law);
    int refitted = 0;
    for (const ScreenedEffect& screened : screened_[law]) {
        if (has_claim() || leaves_only_noise(baselines_.best(), options_)) return;
        const auto tried = std::ranges::find_if(tried_, [&](const FittedExplanation& one) {
            return one.effects.size() == 1 && one.has(screened.effect->name());
        });
        if (tried != tried_.end() && tried->fit.explanation.law == law) continue;
        const double leads = leader() ? leader()->log_bayes_factor : 0;
        const bool may_lead = refitted < most_refits && screened.log_bayes_factor >= options_.least_screen &&
                              screened.at_most() - behind > leads;
        if (!may_lead && !screened.effect->evades_screen()) continue;
        if (could_explain_anything(base, *screened.effect)) continue;
        report(progress_, fmt::format("refit with {}, law {}", screened.effect->name(), model_.laws()[law]), 0.77);
        ++refitted;
        std::optional<FittedExplanation> found = refit_with(base, screened);
        if (found) keep_better(std::move(*found));
    }
}

/// In the place of an explanation by the same effects, if it explains more.
void Search::keep_better(FittedExplanation found) {
    const auto before = std::ranges::find_if(tried_, [&](const FittedExplanation& tried) {
        return std::ranges::is_permutation(tried.effects, found.effects);
    });
    if (before == tried_.end()) {
        tried_.push_back(std::move(found));
    } else if (found.log_bayes_factor > before->log_bayes_factor) {
        *before = std::move(found);
    }
}

/// What is missing may bend the baseline's stiffness far away from how the body answers to loads, and the fits with it:
/// a soft body that hangs under its weight looks as stiff as steel. So fits start there as well, and the better one is
/// kept.
void Search::confirm_at_load_response(int law) {
    constexpr double much = 3;              // whitened rms: where less is left, little has bent the fit
    const double far = std::log(3.0);       // of Young's modulus, or what stands for it: design choice
    constexpr std::size_t most_refits = 3;  // of effects, by the screen from there: the price of another start
    const Refit& base = *baselines_.under(law);
    if (base.whitened_rms < much) return;
    RefitOptions without_steps = options_.refit;
    without_steps.steps = 0;
    std::optional<Refit> there;
    try {
        Explanation guess = base.explanation;
        guess.theta = first_guess(model_, problem_, law, options_.refit.threads).theta;
        if (std::abs(guess.theta[0] - base.explanation.theta[0]) < far) return;
        there = refit(model_, problem_, guess, without_steps);
    } catch (const SolverFailure&) {
        return;
    }
    const std::vector<ScreenedEffect> screened = screen_at(*there, {});
    for (std::size_t i = 0; i < std::min(most_refits, screened.size()); ++i) {
        report(progress_, "refit with " + screened[i].effect->name(), 0.7);
        if (std::optional<FittedExplanation> found = refit_with(*there, screened[i])) keep_better(std::move(*found));
    }
}

/// The fit once more under another law, from its own numbers.
std::optional<FittedExplanation> Search::carry_over(const FittedExplanation& single, int law) const {
    Explanation explanation = single.fit.explanation;
    explanation.law = law;
    return refit_from(explanation, single.fit, single.effects);
}

void Search::try_other_laws(std::size_t tried) {
    FittedExplanation& single = tried_[tried];
    const int own = single.fit.explanation.law;
    for (int law = 0; law < baselines_.laws(); ++law) {
        if (law == own || !baselines_.under(law)) continue;
        const auto tell = [&] {
            report(progress_, fmt::format("refit with {}, law {}", single.effects.front()->name(), model_.laws()[law]),
                   0.75);
        };
        std::optional<FittedExplanation> other;
        if (law > 0 && own > 0) {
            // next to another law of large deformation; a matter of what little is left, where it does as well without
            constexpr double as_well = 20;  // ln of evidence: design choice, a law that lags by more is not fitted
            if (!leaves_only_noise(single.fit, options_)) continue;
            if (baselines_.evidence(law) + as_well < baselines_.evidence(own)) continue;
            tell();
            other = carry_over(single, law);
        } else {
            const auto screened = std::ranges::find(screened_[law], single.effects.front(), &ScreenedEffect::effect);
            if (screened == screened_[law].end()) continue;
            const double lead = baselines_.best().log_evidence - baselines_.evidence(law);
            if (screened->at_most() < single.log_bayes_factor + lead) continue;
            tell();
            other = carry_over(single, law);
            if (!other) other = refit_with(*baselines_.under(law), *screened);
        }
        if (other && other->log_bayes_factor > single.log_bayes_factor) single = std::move(*other);
    }
}

}  // namespace palpate::identify
