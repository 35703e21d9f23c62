#include "identify/diagnosis/verdict/verdict.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "identify/diagnosis/fit/priors/fit_priors.h"
#include "identify/diagnosis/statistics/chance.h"
#include "identify/diagnosis/statistics/mesh_evidence.h"
#include "identify/diagnosis/verdict/next_probe.h"
#include "identify/effects/catalogue.h"

namespace palpate::identify {
namespace {

/// Outliers as a candidate: they have no numbers of the fit.
Candidate outlier_candidate(const Diagnosis& diagnosis) {
    Candidate candidate{.effect = effect_of_single_readings(),
                        .screened = diagnosis.outliers.log_bayes_factor,
                        .log_bayes_factor = diagnosis.outliers.log_bayes_factor};
    if (diagnosis.outliers.readings.empty()) return candidate;
    const auto count = static_cast<double>(diagnosis.outliers.readings.size());
    const double all = count + diagnosis.problem.readings();
    candidate.estimate.effect = {
        candidate.effect->name(),
        {{"share", count / all, "1"}, {"readings", count, "1"}, {"width", diagnosis.outliers.width, "1"}}};
    candidate.estimate.sd = {std::sqrt(count) / all, 0, 0};
    candidate.predicted_rms_mm = diagnosis.baseline.rms_mm;
    candidate.held_out = diagnosis.baseline_held_out;
    return candidate;
}

/// Two mutually confused effects among three or more: together they may mimic an effect outside the catalogue. Empty:
/// there are none.
std::string put_together_of_aliases(const FittedExplanation& explained) {
    if (explained.effects.size() < 3) return {};
    for (const auto& one : explained.effects) {
        for (const auto& other : explained.effects) {
            const auto& aliases = one->description().confused_with;
            if (std::ranges::find(aliases, other->name()) == aliases.end()) continue;
            return fmt::format("{} and {} are nearly collinear and together mimic another effect", one->name(),
                               other->name());
        }
    }
    return {};
}

/// Does an explanation leave too much of what is beyond the noise without it? Thousands of readings make evidence of
/// little: what is like an error of the mesh took up a third to a half of what a coarse one was off by.
bool leaves_too_much(const Refit& without, const FittedExplanation& explained) {
    const double before = without.whitened_rms * without.whitened_rms;
    const double after = explained.fit.whitened_rms * explained.fit.whitened_rms;
    const double most = std::ranges::all_of(explained.effects, &EffectHypothesis::is_like_mesh_error) ? 0.5 : 1;
    // One standard deviation of a mean square of noise, whose expectation is 1.
    const double chance = std::sqrt(2 / static_cast<double>(explained.fit.residual.size()));
    return after - 1 > most * (before - after) + chance;
}

/// Why an effect of an explanation, as it came out, is none of that kind; empty: nothing speaks against it.
std::string objection_of_effects(const Diagnosis& diagnosis, const FittedExplanation& explained) {
    const auto& all = explained.fit.explanation;
    for (std::size_t e = 0; e < all.effects.size(); ++e) {
        if (!explained.has(all.effects[e]->name())) continue;  // known: no claim
        std::string objection = all.effects[e]->objection(diagnosis.problem, all.values[e]);
        if (!objection.empty()) return objection;
    }
    return {};
}

/// As many numbers as readings that are independent of each other explain whatever was measured.
std::string objection_of_few_readings(const Diagnosis& diagnosis, const FittedExplanation& explained) {
    Eigen::Index numbers = free_numbers(explained.fit);
    for (std::size_t e = 0; e < explained.fit.explanation.effects.size(); ++e)
        if (explained.has(explained.fit.explanation.effects[e]->name()))
            numbers += explained.fit.explanation.effects[e]->count_fitted(std::ssize(explained.fit.numbers[e]));
    if (numbers < diagnosis.independent) return {};
    return fmt::format(
        "including the stiffness it has {} parameters for {} independent readings, enough to fit any data. Read more "
        "markers, or load other places",
        numbers, diagnosis.independent);
}

/// A correct explanation predicts left-out probes better than the baseline, whatever the nuisances absorb. A fault of
/// the measurement may differ from probe to probe: of a left-out one its spread alone is known, and normalised errors
/// have to be the smaller ones.
std::string objection_of_held_out(const Diagnosis& diagnosis, const FittedExplanation& explained) {
    const double with = explained.held_out.rms_mm, without = diagnosis.baseline_held_out.rms_mm;
    if (with <= held_out_tolerance * without) return {};
    const bool has_faults = std::ranges::any_of(explained.effects, [](const auto& one) { return !one->is_of_body(); });
    if (has_faults && explained.held_out.whitened_rms < diagnosis.baseline_held_out.whitened_rms) return {};
    return fmt::format("held-out probes are predicted worse with it, to {:.3g} mm instead of {:.3g} mm", with, without);
}

/// Left-out probes that err by more than noise, and by more than chance lets a right explanation err there, tell of an
/// overfit to single probes.
std::string objection_of_overfit(const Diagnosis& diagnosis, const FittedExplanation& explained,
                                 const DiagnoseOptions& options) {
    const double unseen = explained.held_out.whitened_rms;
    if (unseen <= 1 + options.noise_accuracy) return {};
    const double most = largest_held_out(diagnosis.problem, explained.fit, options.false_refusals);
    if (unseen <= most) return {};
    return fmt::format(
        "on held-out probes its normalised error is {:.3g}, where a right explanation would have at most {:.3g}",
        unseen, most);
}

std::string objection_to(const Diagnosis& diagnosis, const FittedExplanation& explained,
                         const DiagnoseOptions& options) {
    if (leaves_too_much(diagnosis.baseline, explained))
        return "too much of the misfit that it should explain remains beyond the noise, as with discretisation error";
    if (std::string few = objection_of_few_readings(diagnosis, explained); !few.empty()) return few;
    if (std::string worse = objection_of_held_out(diagnosis, explained); !worse.empty()) return worse;
    if (std::string overfit = objection_of_overfit(diagnosis, explained, options); !overfit.empty()) return overfit;
    if (explained.effects.size() == 1 && is_claimable(explained, options) &&
        leaves_only_noise(diagnosis.baseline, options)) {
        const double least = least_next_to_noise(explained, diagnosis.problem, options);
        if (explained.log_bayes_factor < least) {
            return fmt::format(
                "the residual without it is noise already, and its ln Bayes factor of {:.0f} is below the {:.0f} that "
                "noise and discretisation error can produce",
                explained.log_bayes_factor, least);
        }
    }
    return put_together_of_aliases(explained);
}

/// Likely explanations that explain enough and do not fall behind the likeliest, by evidence. Those with an effect that
/// is refused for what it came out as (`refused`) are no rivals; nor are aliases that were put together, of a last
/// resort: what they mimic may be just that.
/// Nothing is claimed that ranks below an effect that could not be fitted (`unfitted`, its evidence by the screen).
std::vector<const FittedExplanation*> explain_alike(const std::vector<const FittedExplanation*>& by_evidence,
                                                    const std::set<const FittedExplanation*>& refused, double unfitted,
                                                    const DiagnoseOptions& options) {
    std::vector<const FittedExplanation*> alike;
    double most = unfitted, of_aliases = -INFINITY;
    for (const FittedExplanation* one : by_evidence) {
        if (!is_claimable(*one, options) || refused.contains(one)) continue;
        const bool is_of_aliases = !put_together_of_aliases(*one).empty();
        double& best = is_of_aliases ? of_aliases : most;
        best = std::max(best, one->log_bayes_factor);
        const bool is_last_resort = std::ranges::any_of(one->effects, &EffectHypothesis::is_last_resort);
        const double rival = is_last_resort ? most : std::max(most, of_aliases);
        const bool leads = rival - one->log_bayes_factor < options.least_lead;
        if (leaves_only_noise(one->fit, options) && leads && one->objection.empty()) alike.push_back(one);
    }
    return alike;
}

/// Each against the others and against nothing, all equally likely before.
void assign_probabilities(std::vector<Candidate>& ranking) {
    double top = 0;
    for (const Candidate& c : ranking) top = std::max(top, c.log_bayes_factor);
    double sum = std::exp(-top);
    for (const Candidate& c : ranking) sum += std::exp(c.log_bayes_factor - top);
    for (Candidate& c : ranking) c.probability = std::exp(c.log_bayes_factor - top) / sum;
}

/// The explanation's effects, those first that say most by themselves; their numbers are those that they have together.
/// Further ones of a kind get rows of their own in the ranking, behind the first.
void name_effects(Diagnosis& diagnosis) {
    const FittedExplanation& explained = *diagnosis.explained;
    std::vector<Candidate> ranking;
    for (const Candidate& c : diagnosis.ranking) {
        const auto count = static_cast<int>(std::ranges::count(explained.effects, c.effect));
        ranking.push_back(c);
        for (int which = 0; which < count; ++which) {
            if (which > 0) ranking.push_back(c);
            diagnosis.explanation.push_back(c.effect->name());
            ranking.back().estimate = explained.estimate(c.effect->name(), which);
        }
    }
    diagnosis.ranking = std::move(ranking);
}

}  // namespace

Eigen::Index free_numbers(const Refit& fit) {
    return (fit.prior_sd.head(fit.explanation.theta.size()).array() > told_prior_sd).count();
}

bool is_claimable(const FittedExplanation& explained, const DiagnoseOptions& options) {
    return explained.log_bayes_factor >= options.least_evidence();
}

bool leaves_only_noise(const Refit& fit, const DiagnoseOptions& options) {
    // Plastic flow accumulates discretisation error, mostly along the border of a support.
    const double most_pull = (fit.explanation.setting().effects.plasticity ? 2 : 1) * options.most_pull;
    return fit.whitened_rms <= options.most_left(fit.error.size()) && fit.nuisance_pull <= most_pull;
}

double least_next_to_noise(const DiagnoseOptions& options) {
    return 2 * options.least_evidence();  // the odds of a claim, squared
}

double least_next_to_noise(const FittedExplanation& explained, const Problem& problem, const DiagnoseOptions& options) {
    const double least = least_next_to_noise(options);
    const auto like = std::ranges::find_if(explained.effects, [](const auto& e) { return e->is_like_mesh_error(); });
    if (like == explained.effects.end()) return least;
    if (problem.discretisation.size() == 0) return least_next_to_noise(**like, problem, options);
    // Readings may come of a mesh as coarse: its error is then as large as what was taken off, else a third of it.
    constexpr double share = 1;
    const double rarity = options.least_evidence();
    const double of_mesh = evidence_of_mesh_error(problem, explained, share, rarity);
    // Each is half the square of a vector's length: the lengths add up where both point the same way.
    return std::max(least, std::pow(std::sqrt(rarity) + std::sqrt(of_mesh), 2));
}

double least_next_to_noise(const EffectHypothesis& effect, const Problem& problem, const DiagnoseOptions& options) {
    const double least = least_next_to_noise(options);
    if (!effect.is_like_mesh_error()) return least;
    // Halved edges leave a third of what they show, where errors fall with the square of the edge.
    constexpr double beyond_halved_edges = 1.0 / 3;
    double in_sigmas = options.mesh_error * problem.displacement().cwiseQuotient(problem.sigma).norm();
    if (problem.discretisation.size() > 0)
        in_sigmas =
            std::max(in_sigmas, beyond_halved_edges * problem.discretisation.cwiseQuotient(problem.sigma).norm());
    return std::max(least, 0.5 * in_sigmas * in_sigmas);
}

double least_next_to_effect(const FittedExplanation& there, const DiagnoseOptions& options) {
    double share = 0;
    for (const auto& one : there.effects) share = std::max(share, one->idealisation_share());
    return std::max({options.idealisation_evidence, share * there.log_bayes_factor, least_next_to_noise(options)});
}

double least_next_to_effect(const FittedExplanation& explained, const FittedExplanation& there, const Problem& problem,
                            const DiagnoseOptions& options) {
    return std::max(least_next_to_effect(there, options), least_next_to_noise(explained, problem, options));
}

double least_next_to_effect(const EffectHypothesis& effect, const FittedExplanation& there, const Problem& problem,
                            const DiagnoseOptions& options) {
    return std::max(least_next_to_effect(there, options), least_next_to_noise(effect, problem, options));
}

void decide_verdict(const BodyModel& model, const DiagnoseOptions& options, Diagnosis& diagnosis) {
    const bool outliers = !diagnosis.outliers.readings.empty();
    const bool enough = leaves_only_noise(diagnosis.baseline, options);
    std::vector<const FittedExplanation*> by_evidence;
    std::set<const FittedExplanation*> refused;
    for (FittedExplanation& one : diagnosis.tried) {
        one.objection = objection_to(diagnosis, one, options);
        if (one.objection.empty()) {
            one.objection = objection_of_effects(diagnosis, one);
            if (!one.objection.empty()) refused.insert(&one);
        }
        by_evidence.push_back(&one);
        if (one.effects.size() > 1) continue;
        const auto own = std::ranges::find(diagnosis.ranking, one.effects.front(), &Candidate::effect);
        if (own != diagnosis.ranking.end()) own->objection = one.objection;
    }
    std::ranges::stable_sort(by_evidence, std::greater{}, &FittedExplanation::log_bayes_factor);
    // Is there evidence for more than what is claimed? Little of what an error of the mesh brings about is none: what
    // explains less than half of what leads. Design choice between calling a set unexplained and calling it adequate.
    const auto first =
        std::ranges::find_if(by_evidence, [&](const FittedExplanation* one) { return !refused.contains(one); });
    const double most = first == by_evidence.end() ? 0 : (*first)->log_bayes_factor;
    const bool something = std::ranges::any_of(by_evidence, [&](const FittedExplanation* one) {
        return is_claimable(*one, options) && one->objection.empty() && one->log_bayes_factor > 0.5 * most;
    });
    double unfitted = -INFINITY;
    for (const Candidate& c : diagnosis.ranking)
        if (c.is_unfitted) unfitted = std::max(unfitted, c.log_bayes_factor);
    std::vector<const FittedExplanation*> alike = explain_alike(by_evidence, refused, unfitted, options);
    if (diagnosis.large_deformation_failed && !alike.empty()) {
        diagnosis.notes.emplace_back(
            "No effect is claimed: no large-deformation law could be fitted, and the error of small strain resembles "
            "an effect.");
        alike.clear();
    }
    if (alike.size() > 1) {
        diagnosis.verdict = Verdict::ambiguous;
        diagnosis.next_probe = separate(model, diagnosis.problem, alike, options.refit);
    } else if (alike.size() == 1) {
        diagnosis.verdict = Verdict::missing_effect;
    } else if (enough && !something) {
        diagnosis.verdict = outliers ? Verdict::missing_effect : Verdict::adequate;
    } else {
        diagnosis.verdict = Verdict::unexplained;
    }
    if (!alike.empty()) diagnosis.explained = *alike.front();
    diagnosis.law = diagnosis.best().explanation.law;

    // By evidence; with an explanation its first effect leads.
    std::vector<Candidate>& ranking = diagnosis.ranking;
    const auto single_readings = effect_of_single_readings();
    if (!options.leaves_out(*single_readings)) ranking.push_back(outlier_candidate(diagnosis));
    assign_probabilities(ranking);
    std::ranges::stable_sort(ranking, std::greater{}, &Candidate::log_bayes_factor);
    if (diagnosis.explained) name_effects(diagnosis);
    if (outliers && diagnosis.verdict != Verdict::unexplained) diagnosis.explanation.push_back(single_readings->name());
    if (diagnosis.explanation.empty()) return;
    const auto named = std::ranges::find_if(
        ranking, [&](const Candidate& c) { return c.effect->name() == diagnosis.explanation.front(); });
    std::rotate(ranking.begin(), named, named + 1);
}

}  // namespace palpate::identify
