#include "identify/preflight/prospects/effect_prospects.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "identify/diagnosis/statistics/outliers/outliers.h"
#include "identify/diagnosis/verdict/verdict.h"

namespace palpate::identify {
namespace {

/// Place of the lower median, with infinities last.
std::size_t median_place(const std::vector<double>& values) {
    std::vector<std::size_t> order(values.size());
    for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
    std::ranges::stable_sort(order, {}, [&](std::size_t i) { return values[i]; });
    return order[(order.size() - 1) / 2];
}

double largest_mm(const Problem& problem, const Eigen::VectorXd& mm) {
    std::map<std::pair<int, int>, double> squares;  // of a marker in a state
    for (Eigen::Index n = 0; n < mm.size(); ++n) {
        if (problem.is_position(n)) squares[{problem.state[n], problem.channel(n)}] += mm[n] * mm[n];
    }
    double largest = 0;
    for (const auto& [of, square] : squares) largest = std::max(largest, square);
    return std::sqrt(largest);
}

/// `weights` (N): below 1 where more than noise is unsure, as where a force sensor is finer than any mesh.
void tell_trace(const Problem& problem, const Eigen::VectorXd& weights, const Eigen::VectorXd& sigmas, double factor,
                EffectProspect& prospect) {
    const Eigen::VectorXd mm = sigmas.cwiseProduct(problem.sigma);
    prospect.rms_sigma =
        factor * std::sqrt(weights.cwiseProduct(sigmas).squaredNorm() / static_cast<double>(sigmas.size()));
    prospect.rms_mm = factor * problem.rms_mm(mm);
    prospect.max_mm = factor * largest_mm(problem, mm);
    prospect.prior_rms_mm = problem.rms_mm(mm);
}

/// Why an effect that has no numbers in a problem cannot show there, as a clause: "the body has no closed cavity".
std::string why_unshown(const EffectHypothesis& effect) {
    if (effect.is_of_links()) return "it is of a skeleton's links alone, and no solid body has it";
    const EffectDescription& text = effect.description();
    return text.why_unshown.empty() ? "nothing in the set shows it; what would: " + text.reveals : text.why_unshown;
}

}  // namespace

std::vector<EffectProspect> effect_prospects(const BodyModel& model, const Problem& problem, const Whitening& V,
                                             const std::vector<EffectSignature>& signatures,
                                             const DiagnoseOptions& options) {
    const EvidenceOfSignatures evidence(V, signatures);
    std::vector<EffectProspect> result;
    for (std::size_t e = 0; e < signatures.size(); ++e) {
        const EffectHypothesis& effect = *signatures[e].effect;
        EffectProspect& prospect = result.emplace_back(EffectProspect{.effect = signatures[e].effect});
        if (signatures[e].columns.alternatives() == 0) {
            prospect.why_not = why_unshown(effect);
            continue;
        }
        const EffectCases cases = draw_cases(signatures[e]);
        if (cases.alternative.empty()) {
            prospect.why_not = "to first order it alters nothing of what is read in these states";
            continue;
        }
        const auto factors = evidence.least_factors(e, cases,
                                                    {.least_evidence = options.least_evidence(),
                                                     .least_next_to_noise = least_next_to_noise(options),
                                                     .most_left = options.most_left(problem.rows()),
                                                     .least_lead = options.least_lead});
        const auto count = static_cast<double>(factors.named.size());
        prospect.share =
            static_cast<double>(std::ranges::count_if(factors.named, [](double f) { return f <= 1; })) / count;
        const std::size_t median = median_place(factors.named),
                          best = std::ranges::min_element(factors.named) - factors.named.begin();
        prospect.least = factors.named[median];
        prospect.easiest = factors.named[best];
        prospect.seen = factors.seen[median_place(factors.seen)];

        const double told = std::isfinite(prospect.least) ? prospect.least : factors.seen[median];
        const auto at = static_cast<Eigen::Index>(median);
        tell_trace(problem, V.weights(), cases.readings.col(at), std::isfinite(told) ? told : 1, prospect);
        const std::vector<EffectNumber> numbers = effect.numbers(model, problem);
        if (std::isfinite(told)) prospect.own = own_number(effect, numbers, cases.values.col(at), told);
        if (std::isfinite(prospect.easiest))
            prospect.own_easiest =
                own_number(effect, numbers, cases.values.col(static_cast<Eigen::Index>(best)), prospect.easiest);
        prospect.own_prior = own_number(effect, numbers, cases.values.col(at), 1);

        std::map<int, int> held_up;
        for (const int rival : factors.rival) ++held_up[rival];
        for (const auto& [rival, often] : held_up) {
            if (rival >= 0 && 4 * often >= std::ssize(factors.rival))
                prospect.confused_with.push_back(signatures[static_cast<std::size_t>(rival)].effect->name());
        }
    }
    return result;
}

EffectProspect prospect_of_single_readings(const std::shared_ptr<const EffectHypothesis>& effect,
                                           const Problem& problem, const DiagnoseOptions& options) {
    EffectProspect prospect{.effect = effect};
    const auto is_told = [&](double sigmas) {
        Eigen::VectorXd residual = Eigen::VectorXd::Zero(problem.rows());
        for (Eigen::Index n = 0; n < problem.rows(); ++n) {
            if (!problem.is_position(n)) continue;
            residual[n] = sigmas;
            break;
        }
        return find_outliers(problem, residual).log_bayes_factor >= options.least_outliers;
    };
    constexpr double most = 1e4;  // sigmas: beyond any instrument's slip
    if (!is_told(most)) {
        prospect.why_not = "the set has too few readings for one of them to stand out";
        return prospect;
    }
    double low = 1, high = most;
    while (high > 1.01 * low) {
        const double middle = std::sqrt(low * high);
        (is_told(middle) ? high : low) = middle;
    }
    prospect.share = 1;
    prospect.least = prospect.easiest = prospect.seen = 1;
    const double rows = static_cast<double>(problem.rows());
    prospect.rms_sigma = high / std::sqrt(rows);
    prospect.max_mm = high * problem.rms_sigma();
    prospect.rms_mm = prospect.max_mm / std::sqrt(rows);
    prospect.prior_rms_mm = prospect.rms_mm;
    prospect.own = prospect.own_easiest = prospect.own_prior = OwnNumber{"width", "sigma", high};
    return prospect;
}

}  // namespace palpate::identify
