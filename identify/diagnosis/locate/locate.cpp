#include "identify/diagnosis/locate/locate.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include "identify/diagnosis/locate/sources/source_laws.h"
#include "identify/diagnosis/locate/sources/source_scan.h"

namespace palpate::identify {
namespace {

double log_sum(const std::vector<Alternative>& all, SourceKind kind) {
    double most = -INFINITY;
    for (const Alternative& one : all)
        if (one.kind == kind) most = std::max(most, one.log_weight);
    if (!std::isfinite(most)) return most;
    double sum = 0;
    for (const Alternative& one : all)
        if (one.kind == kind) sum += std::exp(one.log_weight - most);
    return most + std::log(sum);
}

bool is_same_but_for_place(const Alternative& a, const Alternative& b) {
    return a.basis == b.basis && a.term.law == b.term.law && a.term.number == b.term.number;
}

/// Shares the evidence of alternatives that differ in their place out among them by how well each fits.
void share_out(std::vector<Alternative>& all) {
    for (auto first = all.begin(); first != all.end();) {
        const auto end = std::find_if_not(first, all.end(),
                                          [&](const Alternative& one) { return is_same_but_for_place(*first, one); });
        double most = -INFINITY, fit = -INFINITY;
        for (auto one = first; one != end; ++one) {
            most = std::max(most, one->log_weight);
            fit = std::max(fit, one->log_fit);
        }
        double evidence = 0, sum = 0;
        for (auto one = first; one != end; ++one) {
            evidence += std::exp(one->log_weight - most);
            sum += std::exp(one->log_fit - fit);
        }
        for (auto one = first; one != end; ++one)
            one->log_weight = most + std::log(evidence) + one->log_fit - fit - std::log(sum);
        first = end;
    }
}

/// Of each form and law the likeliest place, the likeliest of those that are farther from it than `apart`, and all of
/// the body; the likeliest first.
std::vector<MissingSource::Rival> rivals_among(const std::vector<Alternative>& all, double apart) {
    std::vector<const Alternative*> chosen;
    const auto keep_likeliest = [&](auto first, auto end, const auto& may) {
        const Alternative* best = nullptr;
        for (auto one = first; one != end; ++one)
            if (may(*one) && (!best || one->log_weight > best->log_weight)) best = &*one;
        if (best) chosen.push_back(best);
        return best;
    };
    for (auto first = all.begin(); first != all.end();) {
        const auto end = std::find_if_not(first, all.end(),
                                          [&](const Alternative& one) { return is_same_but_for_place(*first, one); });
        const Alternative* best = keep_likeliest(first, end, [](const Alternative&) { return true; });
        keep_likeliest(first, end, [&](const Alternative& one) {
            return !std::isinf(one.term.radius) && (one.term.centre - best->term.centre).norm() > apart;
        });
        if (!std::isinf(best->term.radius))
            keep_likeliest(first, end, [](const Alternative& one) { return std::isinf(one.term.radius); });
        first = end;
    }
    std::ranges::stable_sort(chosen, [](const auto* a, const auto* b) { return a->log_weight > b->log_weight; });
    std::vector<MissingSource::Rival> rivals;
    rivals.reserve(chosen.size());
    for (const Alternative* one : chosen) rivals.push_back({one->kind, one->term, one->log_weight});
    return rivals;
}

/// Place, spread and direction, averaged over the terms.
void summarise(MissingSource& source) {
    Vec3 along = Vec3::Zero();
    for (const SourceTerm& term : source.terms) {
        source.at += term.probability * term.centre;
        if (is_vector(term.form)) along += term.probability * term.mean.head<3>().normalized();
    }
    double squares = 0;
    for (const SourceTerm& term : source.terms)
        squares += term.probability * ((term.centre - source.at).squaredNorm() + term.extent * term.extent);
    source.spread = std::sqrt(squares);
    const SourceTerm& first = source.likeliest();
    if (!is_vector(first.form)) {
        source.direction = first.axis;
        if (first.form == SourceForm::frame) source.direction = first.mean.head<3>().normalized();
        return;
    }
    if (!(along.norm() > 0)) return;
    source.direction = along.normalized();
    // Of the likeliest term's vector across its direction, and of how the terms differ.
    const Mat3 across = Mat3::Identity() - source.direction * source.direction.transpose();
    const double own =
        std::sqrt((across * first.covariance.topLeftCorner<3, 3>() * across).trace() / 2) / first.mean.head<3>().norm();
    const double between = std::sqrt(std::max(0.0, 1 - along.squaredNorm()));
    source.direction_sd = std::hypot(own, between);
}

}  // namespace

std::optional<MissingSource> locate_missing(const BodyModel& model, const Problem& problem, const Refit& fit,
                                            int threads, const std::function<bool(const SourceTerm&)>& is_candidate) {
    if (problem.rows() == 0 || model.skin().rows() == 0) return std::nullopt;
    SourceScan scan(model, problem, fit, threads);
    std::vector<Alternative> all = scan.alternatives();
    if (is_candidate) std::erase_if(all, [&](const Alternative& one) { return !is_candidate(one.term); });
    if (all.empty()) return std::nullopt;
    MissingSource source;
    share_out(all);
    for (std::size_t kind = 0; kind < source_kind_names.size(); ++kind)
        source.log_bayes_factors[kind] = log_sum(all, static_cast<SourceKind>(kind));
    source.kind =
        static_cast<SourceKind>(std::ranges::max_element(source.log_bayes_factors) - source.log_bayes_factors.begin());
    const double sum = source.log_bayes_factor();
    constexpr double apart =
        0.25;  // of the body's size: design choice, nearer ones are one place for a source of the largest size
    source.rivals = rivals_among(all, apart * model.size());
    std::erase_if(all, [&](const Alternative& one) {
        constexpr double negligible = 1e-3;  // probability: what is below adds little to a mean, and would be stored
        return one.kind != source.kind || one.log_weight - sum < std::log(negligible);
    });
    if (all.empty()) return std::nullopt;
    std::ranges::stable_sort(all, std::greater{}, &Alternative::log_weight);
    double kept = 0;
    for (const Alternative& one : all) kept += std::exp(one.log_weight - sum);
    source.states = states_shown(problem, scan.altered(all.front()));
    source.explained = all.front().explained;
    for (Alternative& one : all) {
        one.term.probability = std::exp(one.log_weight - sum) / kept;
        source.terms.push_back(std::move(one.term));
    }
    summarise(source);
    return source;
}

}  // namespace palpate::identify
