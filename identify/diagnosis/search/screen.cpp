#include "identify/diagnosis/search/screen.h"

#include <cmath>

#include "identify/diagnosis/search/screen_plan.h"
#include "identify/numerics/summaries.h"

namespace palpate::identify {
namespace {

/// All columns side by side, with their prior precisions.
struct Stack {
    Eigen::MatrixXd columns;
    Eigen::VectorXd precisions;

    void add(const Eigen::MatrixXd& more, const Eigen::VectorXd& more_precisions) {
        Eigen::MatrixXd wider(more.rows(), columns.cols() + more.cols());
        Eigen::VectorXd longer(precisions.size() + more_precisions.size());
        if (columns.cols() > 0) wider.leftCols(columns.cols()) = columns;
        wider.rightCols(more.cols()) = more;
        longer << precisions, more_precisions;
        columns = std::move(wider);
        precisions = std::move(longer);
    }
};

/// What a fit leaves, with its own numbers among what may always be wrong: d about their priors' means.
struct FitResidual {
    const Refit& fit;
    Stack always;
    Eigen::VectorXd off_mean, d;
    Whitening V;

    explicit FitResidual(const Refit& from)
        : fit(from),
          always(stack_of(from)),
          off_mean(from.explanation.all() - from.prior_mean),
          d(from.error + from.columns * off_mean),
          V(from.V->weights(), always.columns, always.precisions) {}

    static Stack stack_of(const Refit& fit) {
        Stack stack;
        stack.add(fit.columns, fit.prior_sd.cwiseAbs2().cwiseInverse());
        stack.add(fit.nuisances.columns, fit.nuisances.precisions);
        return stack;
    }

    /// What is left of the positions once columns are in, contacts as they are told: the fit's numbers and the
    /// effect's move, no nuisance [mm].
    double predicted_rms(const Problem& problem, const Eigen::MatrixXd& columns, const Eigen::VectorXd& sd) const {
        Stack with = always;
        with.add(columns, sd.cwiseAbs2().cwiseInverse());
        const Eigen::VectorXd moved = Whitening(fit.V->weights(), with.columns, with.precisions)
                                          .nuisances(d)
                                          .cwiseQuotient(with.precisions.cwiseSqrt());
        const Eigen::VectorXd left =
            fit.error - fit.columns * (moved.head(off_mean.size()) - off_mean) - columns * moved.tail(columns.cols());
        return problem.rms_mm(left.cwiseProduct(problem.sigma));
    }
};

ScreenedEffect score_columns(const Problem& problem, const FitResidual& residual, const ScreenColumns& b,
                             const ScreenPlan& plan) {
    const Eigen::Index p = b.prior_sd.size();
    const std::vector<ScreenResult> all = screen_alternatives(residual.V, residual.d, b.columns, b.prior_sd);
    ScreenedEffect result{.effect = nullptr, .log_bayes_factor = -INFINITY, .identifiable = 0, .predicted_rms_mm = 0};
    std::size_t best = 0;
    std::vector<double> evidence;
    for (const ScreenResult& one : all) {
        const double own =
            b.one_sided ? one_sided_evidence(one.log_bayes_factor, one.value.sum()) : one.log_bayes_factor;
        evidence.push_back(own);
        if (own > evidence[best]) best = evidence.size() - 1;
    }
    result.log_bayes_factor = log_mean_exp(evidence);
    result.identifiable = all[best].identifiable;
    const auto columns = b.columns.middleCols(static_cast<Eigen::Index>(best) * p, p);
    result.predicted_rms_mm = residual.predicted_rms(problem, columns, b.prior_sd);
    for (const double share : {1.0, 0.3, 0.1, 0.03}) {  // half decades: see start_of
        const Eigen::VectorXd start = plan.start(static_cast<Eigen::Index>(best), share * all[best].value);
        if (result.starts.empty() || start != result.starts.back()) result.starts.push_back(start);
    }
    if (!plan.place) return result;
    constexpr double nearly = 0.9;  // of the best one's evidence; design choice, it may cost a second refit
    double second = nearly * evidence[best];
    for (std::size_t i = 0; i < evidence.size(); ++i) {
        const auto alternative = static_cast<Eigen::Index>(i);
        if (evidence[i] <= second || plan.place(alternative) == plan.place(static_cast<Eigen::Index>(best))) continue;
        second = evidence[i];
        result.elsewhere = plan.start(alternative, all[i].value);
    }
    return result;
}

}  // namespace

std::vector<ScreenedEffect> screen_effects(const BodyModel& model, const Problem& problem, const Refit& fit,
                                           const std::vector<std::shared_ptr<const EffectHypothesis>>& effects,
                                           int threads) {
    // Effects with a memory ask stage by stage.
    const Problem stages = problem.by_stage ? problem : problem.stage_by_stage();
    const Refit in_stages = problem.by_stage ? fit : expand_to_stages(model, fit, problem, stages);
    const FitResidual residual(fit);

    std::vector<ScreenedEffect> result(effects.size());
    for (const bool memory : {false, true}) {
        const Problem& asked = memory ? stages : problem;
        const Refit& at = memory ? in_stages : fit;
        std::vector<std::size_t> places;
        std::vector<ScreenPlan> plans;
        std::vector<Signatures> signatures;
        for (std::size_t e = 0; e < effects.size(); ++e) {
            if (effects[e]->has_memory() != memory || effects[e]->numbers(model, problem).empty()) continue;
            places.push_back(e);
            plans.push_back(screen_plan(*effects[e], model, asked, at.explanation, at.forward));
            signatures.push_back(plans.back().signatures);
        }
        if (plans.empty()) continue;
        const std::vector<Eigen::MatrixXd> answered =
            sensitivities(model, asked, at.explanation, at.forward, signatures, threads);
        for (std::size_t i = 0; i < plans.size(); ++i) {
            const ScreenColumns b = plans[i].columns(answered[i]);
            if (b.alternatives() == 0) continue;
            result[places[i]] = score_columns(problem, residual, b, plans[i]);
            result[places[i]].effect = effects[places[i]];
            result[places[i]].scan = std::move(plans[i].scan);
        }
    }
    std::erase_if(result, [](const ScreenedEffect& screened) { return !screened.effect; });
    return result;
}

Eigen::VectorXd start_of(const ScreenedEffect& screened, double without,
                         const std::function<double(const Eigen::VectorXd& start)>& objective) {
    if (screened.scan.empty()) {
        // A linearisation may promise too much: then less of the effect.
        for (const Eigen::VectorXd& start : screened.starts) {
            if (screened.starts.size() == 1 || objective(start) < without) return start;
        }
        return screened.starts.back();
    }
    constexpr double alike = 1;  // ln of evidence: below its threshold an effect does nothing
    double least = INFINITY;
    Eigen::VectorXd best = screened.starts.front();
    int worse = 0;
    for (const Eigen::VectorXd& start : screened.scan) {
        const double begins = objective(start);
        worse = begins > least + alike ? worse + 1 : 0;
        if (worse == 2) break;  // twice by more than chance: more of it is worse still
        if (!(begins < least)) continue;
        least = begins;
        best = start;
    }
    return best;
}

Refit expand_to_stages(const BodyModel& model, const Refit& fit, const Problem& merged, const Problem& stages) {
    const ModelSetting setting = fit.explanation.setting();
    Refit result = fit;
    const auto count = stages.actions.size();
    result.forward = {stages.actions, std::vector<Eigen::VectorXd>(count), std::vector<Points>(count),
                      std::vector<Points>(count)};
    for (std::size_t k = 0; k < count; ++k) {
        const int own = stages.action_in(merged, static_cast<int>(k));
        if (own < 0) {  // it was not read
            result.forward.q[k] = model.rest(setting);
            result.forward.channels[k] = result.forward.markers[k] =
                channels_of(model, stages, setting, {}, result.forward.q[k]);
            continue;
        }
        result.forward.actions[k] = fit.forward.actions[own];
        result.forward.q[k] = fit.forward.q[own];
        result.forward.channels[k] = fit.forward.channels[own];
        result.forward.markers[k] = fit.forward.markers[own];
    }
    return result;
}

}  // namespace palpate::identify
