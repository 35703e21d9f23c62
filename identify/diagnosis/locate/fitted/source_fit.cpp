#include "identify/diagnosis/locate/fitted/source_fit.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <utility>

#include "identify/diagnosis/fit/refit.h"
#include "identify/diagnosis/locate/fitted/source_effect.h"
#include "identify/diagnosis/locate/sources/source_evidence.h"
#include "identify/diagnosis/locate/sources/source_laws.h"
#include "identify/effects/catalogue.h"
#include "mesh/errors.h"

namespace palpate::identify {
namespace {

/// Where a term's weight is in the body or on its skin: its centroid; sets how far it reaches and what it sums up to.
Vec3 centroid_of(SourceTerm& term, const Points& points, const Eigen::VectorXd& shares) {
    const WeightPlace place = place_of(shares.cwiseProduct(source_weight(term.centre, term.radius, points)), points);
    term.norm = place.norm;
    if (!(term.norm > 0)) return term.centre;  // far outside of the body
    term.extent = place.extent;
    return place.centroid;
}

/// What is alike in all states: of each coordinate that is read the mean over its states, of each row (N x c).
Eigen::MatrixXd common_to_states(const Problem& problem, const Eigen::MatrixXd& of_rows) {
    std::map<int, std::vector<Eigen::Index>> rows_of;
    for (Eigen::Index n = 0; n < problem.rows(); ++n)
        if (!problem.is_difference(n)) rows_of[problem.coordinate[n]].push_back(n);
    Eigen::MatrixXd common = Eigen::MatrixXd::Zero(of_rows.rows(), of_rows.cols());
    for (const auto& [coordinate, rows] : rows_of)
        common(rows, Eigen::all).rowwise() = of_rows(rows, Eigen::all).colwise().mean();
    return common;
}

/// What is left alike in all states once a fit's numbers are those that tell the states apart best, to first order [as
/// the readings] (N).
Eigen::VectorXd left_in_common(const Problem& problem, const Refit& fit) {
    const Eigen::MatrixXd columns = fit.columns - common_to_states(problem, fit.columns);
    const Eigen::VectorXd error = fit.error - common_to_states(problem, fit.error);
    Eigen::MatrixXd H = columns.transpose() * columns;
    H.diagonal() += fit.prior_sd.cwiseAbs2().cwiseInverse();
    const Eigen::VectorXd step = H.llt().solve(columns.transpose() * error);
    return common_to_states(problem, (fit.error - fit.columns * step).cwiseProduct(problem.sigma));
}

/// A source fitted to the readings.
struct FittedSource {
    MissingSource::Rival located;
    SourceTerm term;
    Refit fit;
    double log_bayes_factor = 0;  // against none, on the scale of those to first order
};

/// The evidence of a fit against that of one without its source, by what the models next to a source may err.
double log_bayes_factor(const Problem& problem, const Refit& fit, const Refit& without) {
    const auto rows = static_cast<double>(problem.rows());
    const double independent = independent_errors(rows, read_states(problem));
    const auto chi_square = [&](const Refit& one) { return rows * one.whitened_rms * one.whitened_rms; };
    const auto deviance = [&](const Refit& one) { return source_deviance(chi_square(one), rows, independent); };
    const double excess = (chi_square(fit) - deviance(fit)) - (chi_square(without) - deviance(without));
    return fit.log_evidence - without.log_evidence + 0.5 * excess;
}

/// From where an explanation stands, whose last effect is the source; `near`: a fit not far from there.
std::optional<FittedSource> fitted(const BodyModel& model, const Problem& problem, const MissingSource::Rival& located,
                                   const Explanation& start, const Refit& near, const Refit& without,
                                   const RefitOptions& options) {
    try {
        Refit fit = refit(model, problem, start, options, &near);
        if (!(fit.log_evidence > without.log_evidence)) return std::nullopt;
        SourceTerm term = term_of(located.term, fit);
        const double evidence = log_bayes_factor(problem, fit, without);
        return FittedSource{located, std::move(term), std::move(fit), evidence};
    } catch (const SolverFailure&) {  // to first order it is too strong for the body
        return std::nullopt;
    }
}

/// The likeliest of some fits: of each effect from its likeliest place and from all of the body, then of the likeliest
/// effect from other places, and under other laws.
std::optional<FittedSource> likeliest_fit(const BodyModel& model, const Problem& problem,
                                          const std::vector<MissingSource::Rival>& rivals, const Refit& beside,
                                          const Refit& without, const DiagnoseOptions& options) {
    RefitOptions how = options.refit;
    std::optional<FittedSource> best;
    const auto keep_likelier = [&](std::optional<FittedSource> found) {
        if (!found || (best && best->log_bayes_factor >= found->log_bayes_factor)) return;
        best = std::move(found);
        how.rival = best->fit.whitened_rms;
    };
    const auto try_from = [&](const MissingSource::Rival& located) {
        const auto effect = find_effect(effect_of(located.term));
        Explanation start = beside.explanation;
        start.effects.push_back(effect);
        start.values.push_back(effect->values(effect->numbers(model, problem), record_of(located.term, model.size())));
        keep_likelier(fitted(model, problem, located, start, beside, without, how));
    };
    std::set<std::pair<std::string, bool>> tried;  // in one place, or all over the body
    std::vector<const MissingSource::Rival*> others;
    for (const MissingSource::Rival& rival : rivals) {
        const std::string effect = effect_of(rival.term);
        if (effect.empty()) continue;
        if (tried.emplace(effect, std::isinf(rival.term.radius)).second)
            try_from(rival);
        else
            others.push_back(&rival);
    }
    if (!best) return best;
    const std::string effect = best->fit.explanation.effects.back()->name();
    std::erase_if(others, [&](const auto* rival) { return effect_of(rival->term) != effect; });
    constexpr std::size_t places = 3;  // besides the likeliest: each costs a fit
    for (std::size_t i = 0; i < std::min(places, others.size()); ++i) try_from(*others[i]);
    if (options.law) return best;
    // Which law is the likeliest without the source says little of which is with it.
    const FittedSource from = *best;
    for (int law = 0; law < static_cast<int>(model.laws().size()); ++law) {
        Explanation start = from.fit.explanation;
        if (std::exchange(start.law, law) != law)
            keep_likelier(fitted(model, problem, from.located, start, from.fit, without, how));
    }
    return best;
}

}  // namespace

Refit beside_constant_sources(const BodyModel& model, const Problem& problem, const Refit& fit,
                              const RefitOptions& options) {
    // What is alike is told anew as the stiffness changes; design choice, each round costs a fit.
    constexpr int rounds = 3;
    constexpr double most = 0.5;  // of the square error: where less is alike, it does not lead the fit
    Problem apart = problem;
    Eigen::VectorXd taken = Eigen::VectorXd::Zero(problem.rows());
    Refit at = fit;
    for (int round = 0; round < rounds; ++round) {
        const Eigen::VectorXd common = left_in_common(problem, at);
        if (common.cwiseQuotient(problem.sigma).squaredNorm() < most * at.error.squaredNorm()) break;
        apart.measured -= common;
        taken += common;
        try {
            at = refit(model, apart, at.explanation, options, &at);
        } catch (const SolverFailure&) {
            return fit;
        }
    }
    at.error += taken.cwiseQuotient(problem.sigma);
    return at;
}

std::optional<Refit> fit_source(const BodyModel& model, const Problem& problem, const Refit& beside,
                                const Refit& without, const DiagnoseOptions& options, MissingSource& source) {
    std::optional<FittedSource> best = likeliest_fit(model, problem, source.rivals, beside, without, options);
    if (!best) return std::nullopt;
    const auto is_likelier = [&](const MissingSource::Rival& one) {  // and nothing that could be fitted
        return !*effect_of(one.term) && one.log_weight > best->log_bayes_factor;
    };
    if (std::ranges::any_of(source.rivals, is_likelier)) return std::nullopt;
    const Refit& fit = best->fit;
    SourceTerm& term = best->term;
    source.kind = best->located.kind;
    for (double& evidence : source.log_bayes_factors) evidence = std::min(evidence, best->log_bayes_factor);
    source.log_bayes_factors[static_cast<std::size_t>(source.kind)] = best->log_bayes_factor;
    const bool on_skin = term.form == SourceForm::normal || term.form == SourceForm::traction;
    source.at = on_skin ? centroid_of(term, model.skin(), model.skin_areas() / model.skin_areas().sum())
                        : centroid_of(term, model.material_points(), model.material_shares());
    const Eigen::Index place = fit.explanation.all().size() - fit.explanation.values.back().size();
    source.spread = std::sqrt(term.extent * term.extent + fit.covariance.diagonal().segment<3>(place).sum());
    source.direction = Vec3::Zero();
    source.direction_sd = 0;
    if (term.form == SourceForm::force || term.form == SourceForm::traction) {
        const double size = term.mean.norm();
        source.direction = term.mean / size;
        const Mat3 across = Mat3::Identity() - source.direction * source.direction.transpose();
        source.direction_sd = std::sqrt((across * term.covariance * across).trace() / 2) / size;
    }
    source.states = states_shown(problem, beside.error - fit.error);
    const double before = without.whitened_rms * without.whitened_rms, after = fit.whitened_rms * fit.whitened_rms;
    source.explained = std::clamp(1 - after / before, 0.0, 1.0);
    source.terms = {std::move(term)};
    return std::move(best->fit);
}

}  // namespace palpate::identify
