#include "identify/diagnosis/locate/residual.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "identify/diagnosis/locate/locate.h"
#include "identify/effects/catalogue.h"
#include "mesh/errors.h"

namespace palpate::identify {
namespace {

/// The effect that a source is; "": models have none for it.
const char* effect_of(const SourceTerm& term) {
    const bool is_constant = term.law == SourceLaw::constant;
    switch (term.form) {
        case SourceForm::force:
        case SourceForm::traction:
            return is_constant ? "local-force" : "";
        case SourceForm::normal:
            if (term.law == SourceLaw::spring) return term.mean[0] > 0 ? "local-springs" : "";
            return is_constant ? "local-force" : "";
        case SourceForm::softening:
            return is_constant && std::isfinite(term.radius) ? "inclusion" : "";
        default:
            return "";
    }
}

void tell_vector(const std::array<const char*, 3>& names, const Vec3& v, const char* unit,
                 skeleton::EffectRecord& effect) {
    for (int a = 0; a < 3; ++a) effect.parameters.push_back({names[a], v[a], unit});
}

skeleton::EffectRecord record_of(const SourceTerm& term, double size) {
    skeleton::EffectRecord effect{effect_of(term), {}};
    tell_vector({"cx", "cy", "cz"}, term.centre, "mm", effect);
    const double sd = std::min(term.radius, size);
    if (effect.name == "inclusion") {
        // The ball whose points are as far from its middle, rms: 3/5 R^2 = 3 sd^2. First order tells of a large change
        // only that it is large.
        const double most = std::log(8.0);
        effect.parameters.push_back({"radius", std::sqrt(5.0) * sd, "mm"});
        effect.parameters.push_back({"ratio", std::exp(std::clamp(term.mean[0], -most, most)), "1"});
        return effect;
    }
    effect.parameters.push_back({"radius", sd, "mm"});
    if (effect.name == "local-springs") {
        effect.parameters.push_back({"stiffness", term.mean[0], "N/mm"});
    } else {
        const Vec3 force = term.form == SourceForm::normal ? Vec3(term.mean[0] * term.axis) : Vec3(term.mean.head<3>());
        tell_vector({"fx", "fy", "fz"}, force, "N", effect);
    }
    return effect;
}

/// The term of a source whose last effect is a fitted one: its place, and its numbers in the source's own form.
SourceTerm term_of(const SourceTerm& located, const Refit& fit) {
    const Eigen::VectorXd& values = fit.explanation.values.back();
    const Eigen::Index count = values.size(), first = fit.explanation.all().size() - count;
    const Eigen::MatrixXd covariance = fit.covariance.block(first, first, count, count);
    SourceTerm term = located;
    term.centre = values.head<3>();
    term.radius = std::exp(values[3]);
    term.probability = 1;
    Eigen::MatrixXd by_value;  // d numbers / d values behind the place
    if (located.form == SourceForm::softening) {
        term.radius /= std::sqrt(5.0);  // a ball, see record_of
        term.mean = values.tail(1);     // ln ratio
        by_value = Eigen::MatrixXd::Identity(1, 1);
    } else if (located.law == SourceLaw::spring) {
        term.mean = values.tail(1).array().exp();
        by_value = term.mean.asDiagonal();
    } else {
        term.form = located.form == SourceForm::force ? SourceForm::force : SourceForm::traction;
        term.mean = values.tail<3>();
        by_value = Mat3::Identity();
    }
    const Eigen::Index numbers = term.mean.size();
    term.covariance = by_value * covariance.bottomRightCorner(numbers, numbers) * by_value.transpose();
    term.sd = term.covariance.diagonal().cwiseSqrt();
    return term;
}

/// Where a term's weight is in the body or on its skin: its centroid; sets how far it reaches and what it sums up to.
Vec3 centroid_of(SourceTerm& term, const Points& points, const Eigen::VectorXd& shares) {
    const Eigen::VectorXd weight = shares.cwiseProduct(source_weight(term.centre, term.radius, points));
    term.norm = weight.sum();
    if (!(term.norm > 0)) return term.centre;  // far outside of the body
    const Vec3 centroid = points.transpose() * weight / term.norm;
    term.extent = std::sqrt(weight.dot((points.rowwise() - centroid.transpose()).rowwise().squaredNorm()) / term.norm);
    return centroid;
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

}  // namespace

Refit beside_constant_sources(const BodyModel& model, const Problem& problem, const Refit& fit,
                              const RefitOptions& options) {
    constexpr int rounds = 3;  // what is alike is told anew as the stiffness changes
    Problem apart = problem;
    Eigen::VectorXd taken = Eigen::VectorXd::Zero(problem.rows());
    Refit at = fit;
    for (int round = 0; round < rounds; ++round) {
        const Eigen::VectorXd common = left_in_common(problem, at);
        if (common.cwiseQuotient(problem.sigma).squaredNorm() < 0.5 * at.error.squaredNorm()) break;
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

void fit_source(const BodyModel& model, const Problem& problem, const Refit& beside, const Refit& without,
                const RefitOptions& options, MissingSource& source) {
    const SourceTerm located = source.likeliest();
    const std::string name = effect_of(located);
    if (name.empty()) return;
    const auto effect = find_effect(name);
    Explanation explanation = beside.explanation;
    explanation.effects.push_back(effect);
    explanation.values.push_back(effect->values(effect->numbers(model, problem), record_of(located, model.size())));
    std::optional<Refit> fit;
    try {
        fit = refit(model, problem, explanation, options, &beside);
    } catch (const SolverFailure&) {  // to first order it is too strong for the body
        return;
    }
    if (!(fit->log_evidence > without.log_evidence)) return;
    SourceTerm term = term_of(located, *fit);
    const bool on_skin = term.form == SourceForm::normal || term.form == SourceForm::traction;
    source.at = on_skin ? centroid_of(term, model.skin(), model.skin_areas() / model.skin_areas().sum())
                        : centroid_of(term, model.material_points(), model.material_shares());
    const Eigen::Index place = fit->explanation.all().size() - fit->explanation.values.back().size();
    source.spread = std::sqrt(term.extent * term.extent + fit->covariance.diagonal().segment<3>(place).sum());
    if (effect->name() == "local-force") {
        const double size = term.mean.norm();
        source.direction = term.mean / size;
        const Mat3 across = Mat3::Identity() - source.direction * source.direction.transpose();
        source.direction_sd = std::sqrt((across * term.covariance * across).trace() / 2) / size;
    }
    const double before = without.whitened_rms * without.whitened_rms, after = fit->whitened_rms * fit->whitened_rms;
    source.explained = std::clamp(1 - after / before, 0.0, 1.0);
    source.terms = {std::move(term)};
}

std::optional<Residual> find_residual(const BodyModel& model, const Diagnosis& diagnosis, const RefitOptions& options) {
    const auto can_be_shown = [&](const SourceTerm& term) {
        const std::string effect = effect_of(term);
        return !effect.empty() && std::ranges::find(diagnosis.explanation, effect) == diagnosis.explanation.end();
    };
    const Problem& problem = diagnosis.problem;
    const Refit beside = beside_constant_sources(model, problem, diagnosis.best(), options);
    std::optional<MissingSource> source = locate_missing(model, problem, beside, options.threads, can_be_shown);
    if (!source || !(source->log_bayes_factor() > 0)) return std::nullopt;
    fit_source(model, problem, beside, diagnosis.best(), options, *source);
    return Residual{record_of(source->likeliest(), model.size()), source->log_bayes_factor()};
}

}  // namespace palpate::identify
