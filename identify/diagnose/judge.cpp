#include "identify/diagnose/judge.h"

#include <algorithm>
#include <cmath>

#include "identify/diagnose/next_probe.h"
#include "identify/effects/catalogue.h"

namespace palpate::identify {
namespace {

/// Outliers as a candidate: they have no numbers of the fit.
Candidate outlier_candidate(const Diagnosis& diagnosis) {
    Candidate candidate{.effect = find_effect("outliers"),
                        .screened = diagnosis.outliers.log_bayes_factor,
                        .log_bayes_factor = diagnosis.outliers.log_bayes_factor};
    if (diagnosis.outliers.readings.empty()) return candidate;
    const auto count = static_cast<double>(diagnosis.outliers.readings.size());
    const double all = count + diagnosis.problem.readings();
    candidate.told = {
        "outliers", {{"share", count / all, "1"}, {"readings", count, "1"}, {"width", diagnosis.outliers.width, "1"}}};
    candidate.sd = {std::sqrt(count) / all, 0, 0};
    candidate.predicted_rms_mm = diagnosis.baseline.rms_mm;
    candidate.held_out = diagnosis.baseline_held_out;
    return candidate;
}

/// Likely candidates that explain enough and do not fall behind the likeliest, by evidence.
std::vector<const Candidate*> explain_alike(const std::vector<Candidate>& ranking, const DiagnoseOptions& options) {
    std::vector<const Candidate*> alike;
    double most = -INFINITY;
    for (const Candidate& c : ranking) {
        if (!is_likely(c, options)) continue;
        most = std::max(most, c.log_bayes_factor);
        const bool predicts = c.held_out->whitened_rms <= options.most_left_held_out;
        const bool leads = most - c.log_bayes_factor < options.least_lead;
        if (is_enough(*c.refit, options) && predicts && leads && c.objection.empty()) alike.push_back(&c);
    }
    return alike;
}

/// Each against the others and against nothing, all equally likely before.
void share_out_probability(std::vector<Candidate>& ranking) {
    double top = 0;
    for (const Candidate& c : ranking) top = std::max(top, c.log_bayes_factor);
    double sum = std::exp(-top);
    for (const Candidate& c : ranking) sum += std::exp(c.log_bayes_factor - top);
    for (Candidate& c : ranking) c.probability = std::exp(c.log_bayes_factor - top) / sum;
}

}  // namespace

bool is_likely(const Candidate& candidate, const DiagnoseOptions& options) {
    return candidate.refit && candidate.log_bayes_factor >= options.least_evidence;
}

bool is_enough(const Refit& fit, const DiagnoseOptions& options) {
    return fit.whitened_rms <= options.most_left && fit.strain <= options.most_strain;
}

void judge(const BodyModel& model, const DiagnoseOptions& options, Diagnosis& diagnosis) {
    const bool outliers = !diagnosis.outliers.readings.empty();
    const bool enough = is_enough(diagnosis.baseline, options);
    bool something = false;  // is there evidence for more than what is claimed?
    for (Candidate& c : diagnosis.ranking) {
        if (!is_likely(c, options)) continue;
        c.objection = c.effect->objection(diagnosis.problem, c.refit->explanation.values.back(), enough);
        something = true;
    }
    const std::vector<const Candidate*> alike = explain_alike(diagnosis.ranking, options);
    diagnosis.law = diagnosis.baseline.explanation.law;
    if (alike.size() > 1) {
        diagnosis.verdict = Verdict::ambiguous;
        diagnosis.next_probe = separate(model, diagnosis.problem, *alike[0], *alike[1], options.refit.threads);
    } else if (alike.size() == 1) {
        diagnosis.verdict = Verdict::missing_effect;
    } else if (enough && !something) {
        diagnosis.verdict = outliers ? Verdict::missing_effect : Verdict::adequate;
    } else {
        diagnosis.verdict = Verdict::unexplained;
    }
    if (!alike.empty()) {
        diagnosis.explanation.push_back(alike.front()->effect->name());
        diagnosis.law = alike.front()->refit->explanation.law;
    }
    if (outliers && diagnosis.verdict != Verdict::unexplained) diagnosis.explanation.emplace_back("outliers");

    // By evidence; with an explanation its first effect leads.
    std::vector<Candidate>& ranking = diagnosis.ranking;
    const bool outliers_left_out = std::ranges::find(options.without, "outliers") != options.without.end();
    if (!outliers_left_out) ranking.push_back(outlier_candidate(diagnosis));
    share_out_probability(ranking);
    std::ranges::stable_sort(ranking, std::greater{}, &Candidate::log_bayes_factor);
    if (diagnosis.explanation.empty()) return;
    const auto first = std::ranges::find_if(
        ranking, [&](const Candidate& c) { return c.effect->name() == diagnosis.explanation.front(); });
    std::rotate(ranking.begin(), first, first + 1);
}

}  // namespace palpate::identify
