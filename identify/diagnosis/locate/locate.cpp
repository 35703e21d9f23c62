#include "identify/diagnosis/locate/locate.h"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>

#include "identify/diagnosis/locate/sources/source_bases.h"
#include "identify/diagnosis/locate/sources/source_evidence.h"
#include "identify/diagnosis/locate/sources/source_laws.h"

namespace palpate::identify {
namespace {

/// A term with the evidence of its whole set of alternatives still to be divided among them.
struct Alternative {
    SourceKind kind;
    SourceTerm term = {};
    double log_weight = 0;  // evidence and prior
    double log_fit = 0;     // among places of the same form and law, and prior
    double explained = 0;
    const SourceBasis* basis = nullptr;
    std::size_t place = 0;
};

class Scan {
public:
    Scan(const BodyModel& model, const Problem& problem, const Refit& fit, int threads)
        : problem_(problem),
          entries_(reading_entries(problem)),
          bases_(source_bases(model, problem, fit, entries_, threads)),
          V_(with_numbers_unknown(fit)),
          score_(V_, fit.error, read_states(problem)) {}

    std::vector<Alternative> alternatives() {
        const Eigen::VectorXd everywhere = Eigen::VectorXd::Ones(std::ssize(problem_.stages));
        const auto laws = common_laws(problem_);
        const auto probes = probes_alone(problem_);
        for (const SourceBasis& basis : bases_) {
            if (basis.places.empty()) continue;
            if (basis.law) {
                add(basis, *basis.law, everywhere, 0);
                continue;
            }
            // What differs from state to state by no law of load, time or motion touches from outside, or is the
            // camera's.
            const bool alone = basis.form == SourceForm::traction || basis.form == SourceForm::frame;
            const double share = -std::log(static_cast<double>(laws.size() + (alone ? 2 : 0)));
            // A set says what touches the body: that something does in all states, though none says so, is less likely
            // than a force that needs no touch, which it cannot be told from where the body is slender.
            constexpr double unsaid = -2.3;  // ln of a tenth: a prior, design choice
            for (const auto& [law, strength] : laws) {
                const bool touches = basis.kind == SourceKind::boundary && law == SourceLaw::constant;
                add(basis, law, strength, share + (touches ? unsaid : 0));
            }
            if (!alone) continue;
            for (const auto& [probe, strength] : probes)
                add(basis, SourceLaw::one_probe, strength, share - std::log(static_cast<double>(probes.size())), probe);
            add_irregular(basis, share);
        }
        return std::move(found_);
    }

    /// What an alternative alters of the readings, in sigmas of noise (N).
    Eigen::VectorXd altered(const Alternative& one) const {
        return rows_of(*one.basis, one.term.strength, static_cast<Eigen::Index>(one.place), 1) * one.term.mean;
    }

private:
    /// Columns of some of a basis' places, under strengths of each state (N x places p).
    Eigen::MatrixXd rows_of(const SourceBasis& basis, const Eigen::VectorXd& strength, Eigen::Index place,
                            Eigen::Index places) const {
        const Eigen::Index p = basis.width;
        Eigen::MatrixXd result = Eigen::MatrixXd::Zero(problem_.rows(), places * p);
        for (std::size_t e = 0; e < entries_.size(); ++e) {
            const double weight = entries_[e].sign * strength[entries_[e].state];
            if (weight != 0)
                result.row(entries_[e].row) +=
                    weight * basis.columns.row(static_cast<Eigen::Index>(e)).segment(place * p, places * p);
        }
        return result;
    }

    void add(const SourceBasis& basis, SourceLaw law, const Eigen::VectorXd& strength, double log_prior,
             int probe = -1) {
        const auto places = std::ssize(basis.places);
        const std::vector<SourceEvidence> all =
            score_(rows_of(basis, strength, 0, places), basis.width, basis.one_sided);
        for (std::size_t i = 0; i < all.size(); ++i) {
            if (!std::isfinite(all[i].log_bayes_factor)) continue;
            const SourcePlace& place = basis.places[i];
            Alternative one{.kind = basis.kind, .basis = &basis, .place = i};
            one.term = {.form = basis.form,
                        .law = law,
                        .centre = place.centre,
                        .radius = place.radius,
                        .extent = place.extent,
                        .norm = place.norm,
                        .axis = place.axis,
                        .number = probe >= 0 ? probe : place.number,
                        .log_bayes_factor = all[i].log_bayes_factor,
                        .mean = all[i].mean,
                        .sd = all[i].covariance.diagonal().cwiseSqrt(),
                        .covariance = all[i].covariance,
                        .strength = strength};
            one.explained = all[i].explained;
            one.log_weight = all[i].log_bayes_factor + place.log_prior + log_prior;
            one.log_fit = all[i].log_fit + place.log_prior;
            found_.push_back(std::move(one));
        }
    }

    /// A vector of its own in each action, at the place that the laws found likeliest; as if only that place could have
    /// it. Told along the direction that they share most.
    void add_irregular(const SourceBasis& basis, double log_prior) {
        const Alternative* best = nullptr;
        for (const Alternative& one : found_)
            if (one.basis == &basis && (!best || one.log_weight > best->log_weight)) best = &one;
        if (!best || basis.width != 3) return;
        std::vector<int> actions;
        for (const ReadingEntry& entry : entries_)
            if (actions.empty() || actions.back() != entry.action) actions.push_back(entry.action);
        const auto count = std::ssize(actions);
        Eigen::MatrixXd columns = Eigen::MatrixXd::Zero(problem_.rows(), 3 * count);
        const auto first = static_cast<Eigen::Index>(3 * best->place);
        Eigen::Index k = -1;
        int last = -1;
        for (std::size_t e = 0; e < entries_.size(); ++e) {
            if (entries_[e].action != last) ++k;
            last = entries_[e].action;
            columns.row(entries_[e].row).segment<3>(3 * k) +=
                entries_[e].sign * basis.columns.row(static_cast<Eigen::Index>(e)).segment<3>(first);
        }
        const SourceEvidence all = score_(columns, static_cast<int>(3 * count)).front();
        if (!std::isfinite(all.log_bayes_factor)) return;

        const Eigen::Map<const Eigen::MatrixXd> vectors(all.mean.data(), 3, count);
        Vec3 direction = Eigen::SelfAdjointEigenSolver<Mat3>(vectors * vectors.transpose()).eigenvectors().col(2);
        Eigen::VectorXd along = vectors.transpose() * direction;
        Eigen::Index most = 0;
        const double magnitude = along.cwiseAbs().maxCoeff(&most);
        if (!(magnitude > 0)) return;
        const double size = along[most];  // with its sign
        Alternative one = *best;
        one.term.law = SourceLaw::irregular;
        one.term.number = -1;
        one.term.log_bayes_factor = all.log_bayes_factor;
        one.term.mean = size * direction;
        one.term.covariance = all.covariance.block<3, 3>(3 * most, 3 * most);
        one.term.sd = one.term.covariance.diagonal().cwiseSqrt();
        one.term.strength = Eigen::VectorXd::Zero(std::ssize(problem_.stages));
        for (const ReadingEntry& entry : entries_) {
            const auto own = std::ranges::lower_bound(actions, entry.action) - actions.begin();
            one.term.strength[entry.state] = along[own] / size;
        }
        one.explained = all.explained;
        one.log_weight = all.log_bayes_factor + log_prior - std::log(static_cast<double>(basis.places.size()));
        found_.push_back(std::move(one));
    }

    const Problem& problem_;
    std::vector<ReadingEntry> entries_;
    std::vector<SourceBasis> bases_;
    Whitening V_;
    SourceScore score_;
    std::vector<Alternative> found_;
};

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
    Scan scan(model, problem, fit, threads);
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
