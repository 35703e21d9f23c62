#include "identify/diagnosis/locate/residual.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "identify/diagnosis/locate/fitted/source_effect.h"
#include "identify/diagnosis/locate/locate.h"

namespace palpate::identify {
namespace {

/// Single readings that were set aside, as a source.
MissingSource source_of_outliers(const MeasurementSet& set, const Diagnosis& diagnosis) {
    const Problem whole = make_problem(set, 1);
    std::set<int> states;
    std::vector<Vec3> places;
    for (Eigen::Index n = 0; n < whole.rows(); ++n) {
        const bool is_first = n == 0 || whole.reading[n] != whole.reading[n - 1];
        if (!is_first || !std::ranges::binary_search(diagnosis.outliers.readings, whole.reading[n])) continue;
        states.insert(whole.state[n]);
        if (whole.is_position(n)) places.emplace_back(whole.rest.row(whole.channel(n)));
    }
    MissingSource source{.kind = SourceKind::sensor};
    source.log_bayes_factors.fill(-INFINITY);
    source.log_bayes_factors[static_cast<std::size_t>(SourceKind::sensor)] = diagnosis.outliers.log_bayes_factor;
    source.states.assign(states.begin(), states.end());
    SourceTerm term{.form = SourceForm::readings, .law = SourceLaw::irregular, .probability = 1};
    for (const Vec3& place : places) source.at += place / static_cast<double>(places.size());
    double squares = 0;
    for (const Vec3& place : places) squares += (place - source.at).squaredNorm() / static_cast<double>(places.size());
    source.spread = term.extent = std::sqrt(squares);
    term.centre = source.at;
    source.terms = {std::move(term)};
    return source;
}

}  // namespace

std::optional<MissingSource> where_missing(const BodyModel& model, const MeasurementSet& set,
                                           const Diagnosis& diagnosis, const DiagnoseOptions& options) {
    const bool has_outliers = !diagnosis.outliers.readings.empty();
    const bool is_all = diagnosis.explanation.size() == 1 && !diagnosis.explained;
    if (has_outliers && is_all) return source_of_outliers(set, diagnosis);
    const Problem& problem = diagnosis.problem;
    const Refit& baseline = diagnosis.baseline;
    const bool is_named = diagnosis.verdict != Verdict::unexplained;  // then its numbers are those of the effect
    const Refit beside = is_named ? baseline : beside_constant_sources(model, problem, baseline, options.refit);
    std::optional<MissingSource> source = locate_missing(model, problem, beside, options.refit.threads);
    if (source && !is_named) fit_source(model, problem, beside, baseline, options, *source);
    if (!source && has_outliers) return source_of_outliers(set, diagnosis);
    return source;
}

std::optional<Residual> find_residual(const BodyModel& model, const Diagnosis& diagnosis,
                                      const DiagnoseOptions& options) {
    const auto can_be_shown = [&](const SourceTerm& term) {
        const std::string effect = effect_of(term);
        return !effect.empty() && std::ranges::find(diagnosis.explanation, effect) == diagnosis.explanation.end();
    };
    const Problem& problem = diagnosis.problem;
    const Refit beside = beside_constant_sources(model, problem, diagnosis.best(), options.refit);
    std::optional<MissingSource> source = locate_missing(model, problem, beside, options.refit.threads, can_be_shown);
    if (!source || !(source->log_bayes_factor() > 0)) return std::nullopt;
    std::optional<Refit> fit = fit_source(model, problem, beside, diagnosis.best(), options, *source);
    return Residual{record_of(source->likeliest(), model.size()), source->log_bayes_factor(), std::move(fit)};
}

}  // namespace palpate::identify
