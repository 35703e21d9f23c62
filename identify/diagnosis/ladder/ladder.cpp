#include "identify/diagnosis/ladder/ladder.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "identify/comparison/compare.h"
#include "identify/diagnosis/ladder/ladder_body.h"
#include "identify/diagnosis/ladder/ladder_forecast.h"
#include "identify/diagnosis/ladder/ladder_skeleton.h"
#include "identify/diagnosis/ladder/understood_set.h"
#include "identify/diagnosis/statistics/chance.h"
#include "identify/diagnosis/statistics/folds.h"
#include "identify/effects/catalogue.h"
#include "identify/models/skeleton/skeleton_body.h"
#include "identify/numerics/summaries.h"
#include "mesh/errors.h"

namespace palpate::identify {
namespace {

double newtons(const Comparison& comparison) { return comparison.reactions ? comparison.reactions->rms : missing; }

class LadderBuilder {
public:
    LadderBuilder(const skeleton::Model& model, const BodyModel& body, const MeasurementSet& set,
                  const LadderOptions& options, const Diagnosis* diagnosis, const Progress& progress)
        : body_(body, options, diagnosis),
          body_is_skeleton_(dynamic_cast<const SkeletonBody*>(&body) != nullptr),
          set_(set),
          options_(options),
          progress_(progress),
          diagnosis_(diagnosis),
          skeleton_(model, options.identify) {
        for (const std::vector<int>& fold : folds_of(set)) {
            folds_.push_back({part_of(set, fold, false), part_of(set, fold, true)});
            result_.held_out_probes.insert(result_.held_out_probes.end(), fold.begin(), fold.end());
        }
        std::ranges::sort(result_.held_out_probes);
        fitted_ = folds_.size() == 1 ? folds_.front().fitted : set;
    }

    Ladder run(const std::vector<std::string>& effects) {
        add_step({});
        for (std::size_t number = 1; number <= effects.size(); ++number) {
            report(progress_, fmt::format("ladder, step {}", number),
                   static_cast<double>(number) / static_cast<double>(effects.size() + 1));
            try_steps({effects[number - 1]});
        }
        add_those_that_need_each_other(effects);
        // What was named is missing, however little is left without it.
        if (std::ranges::any_of(result_.not_added, [&](const EffectNotAdded& one) { return is_named(one.effect); }))
            result_.verdict = Verdict::missing_effect;
        finish();
        return std::move(result_);
    }

private:
    bool is_named(const std::string& effect) const {
        return diagnosis_ && std::ranges::find(diagnosis_->explanation, effect) != diagnosis_->explanation.end();
    }

    /// Adds these effects, a step each. Where only better ones are added and the last step is worse than the one before
    /// the first, or has no equilibria, none of them is: why not is told of each. True where they are added.
    bool try_steps(const std::vector<std::string>& effects) {
        const std::size_t steps = result_.steps.size(), number = added_.size();
        const LadderSkeleton skeleton = skeleton_;
        const Verdict verdict = result_.verdict;
        std::optional<std::string> why_not;
        try {
            for (const std::string& name : effects) {
                added_.push_back(name);
                add_step(added_);
            }
            if (options_.only_better) why_not = why_not_added(result_.steps[steps - 1], effects);
        } catch (const SolverFailure& failure) {
            if (!options_.only_better) throw;
            why_not = fmt::format("with it a state of the set has no equilibrium: {}", failure.what());
        }
        if (!why_not) return true;
        for (const std::string& name : effects) result_.not_added.push_back({name, *why_not});
        added_.resize(number);
        result_.steps.resize(steps);
        skeleton_ = skeleton;
        result_.verdict = verdict;
        return false;
    }

    /// Effects that a diagnosis names together are its explanation together: one alone may bend the others' share into
    /// its own numbers and forecast worse than none. Those that failed are added once more, all of them, on what has
    /// been added since.
    void add_those_that_need_each_other(const std::vector<std::string>& effects) {
        std::vector<std::string> failed;
        bool others_came_since = false;
        for (const std::string& name : effects) {
            const bool is_added = std::ranges::find(added_, name) != added_.end();
            if (!is_added && is_named(name)) failed.push_back(name);
            others_came_since |= is_added && !failed.empty();
        }
        if (failed.empty() || (failed.size() == 1 && !others_came_since)) return;
        const std::vector<EffectNotAdded> alone = result_.not_added;
        const bool together = try_steps(failed);
        result_.not_added = alone;
        if (!together) return;
        std::erase_if(result_.not_added,
                      [&](const EffectNotAdded& one) { return std::ranges::find(failed, one.effect) != failed.end(); });
    }

    /// In words, where the last step, to which these effects have led, is worse than `before`.
    std::optional<std::string> why_not_added(const LadderStep& before, const std::vector<std::string>& effects) {
        // What a diagnosis names needs no better forecast, by as much as chance may make one worse; what was located in
        // what is left has nothing else to speak for it.
        const bool is_residual = options_.residual && options_.residual->effect.name == effects.back();
        if (is_residual && folds_.empty()) {
            return "there are too few probes to see whether others are forecast better; load the body in three probes "
                   "or more";
        }
        const LadderStep& now = result_.steps.back();
        const std::optional<std::string> worse = what_is_worse(before, now, is_residual ? 1 : held_out_tolerance);
        if (!worse || !is_forecast_by_its_spread(effects.back(), before, now)) return worse;
        result_.notes.push_back(fmt::format(
            "{} is added though {}: it may differ from probe to probe, and of a held-out probe its spread "
            "alone is known, by which the normalised error falls from {:.3g} to {:.3g}",
            effects.back(), *worse, before.reference->held_out_whitened_rms, now.reference->held_out_whitened_rms));
        return {};
    }

    void add_step(const std::vector<std::string>& effects) {
        LadderStep step;
        const Diagnosis found = body_.explained(fitted_, effects);
        const Refit& fit = found.best();
        step.effects = estimate(found);
        step.material = material_of(body_.model(), fit);
        step.log_evidence = fit.log_evidence;
        if (!effects.empty() && diagnosis_) {
            const auto& ranking = diagnosis_->ranking;
            const auto own =
                std::ranges::find_if(ranking, [&](const Candidate& c) { return c.effect->name() == effects.back(); });
            if (own != ranking.end()) step.predicted_rms_mm = own->predicted_rms_mm;
        }
        StepError body;
        take_fitted(body, found);
        result_.verdict = found.verdict;

        // The skeleton with the same physics, fitted to what is left of the measurements.
        const MeasurementSet part = understood(fitted_, step.effects, found.outliers.readings);
        step.model = step.validation_model = skeleton_.fitted(step.effects, part);
        const Comparison on_fitted = compare(step.model, part, options_.identify.threads);
        take_fitted(step.skeleton, on_fitted);
        hold_out(effects, found, step, body);
        if (!body_is_skeleton_) step.reference = body;
        step.set = understood(set_, step.effects, {});
        step.comparison = compare(step.model, step.set, options_.identify.threads);
        result_.steps.push_back(std::move(step));
    }

    static void take_fitted(StepError& error, const Diagnosis& found) {
        const Refit& fit = found.best();
        error.rms_mm = fit.rms_mm;
        error.rms_n = fit.rms_n;
        error.relative = found.problem.relative(fit.error.cwiseProduct(found.problem.sigma));
        error.whitened_rms = fit.whitened_rms;
    }
    static void take_fitted(StepError& error, const Comparison& on_fitted) {
        error.rms_mm = on_fitted.rms;
        error.rms_n = newtons(on_fitted);
        error.relative = on_fitted.relative;
    }

    /// Errors on what is held out, pooled over the folds. `found`, `step`: as fitted to `fitted_`.
    void hold_out(const std::vector<std::string>& effects, const Diagnosis& found, LadderStep& step,
                  StepError& body) const {
        PooledError positions, forces, whitened, positions_of_skeleton, forces_of_skeleton;
        for (const Fold& fold : folds_) {
            const bool is_fitted = folds_.size() == 1;
            const Diagnosis own = is_fitted ? found : body_.explained_again(fold.fitted, found);
            const auto [unseen, predicted] = body_.predicted(fold.held_out, effects, own);
            const Problem problem = make_problem(unseen, own.noise);
            const Eigen::Index positions_read = problem.count_positions(), forces_read = problem.count_forces();
            positions.add(predicted.rms_mm, positions_read);
            forces.add(predicted.rms_n, forces_read);
            whitened.add(predicted.whitened_rms, problem.rows());

            const std::vector<skeleton::EffectRecord> said = estimate(own);
            const MeasurementSet part = understood(fold.fitted, said, own.outliers.readings);
            const skeleton::Model model = is_fitted ? step.model : skeleton_.refitted(said, part);
            const Comparison compared = compare(model, understood(unseen, said, {}), options_.identify.threads);
            positions_of_skeleton.add(compared.rms, positions_read);
            forces_of_skeleton.add(newtons(compared), forces_read);
        }
        if (folds_.empty()) return;
        body.held_out_rms_mm = known_part(positions.rms());
        body.held_out_rms_n = forces.rms();
        body.held_out_whitened_rms = whitened.rms();
        step.skeleton.held_out_rms_mm = known_part(positions_of_skeleton.rms());
        step.skeleton.held_out_rms_n = forces_of_skeleton.rms();
    }

    /// The last step once more, on all states and with particles: the model that is delivered.
    void finish() {
        report(progress_, "the model on all states", 0.9);
        const bool is_known =
            diagnosis_ && std::ranges::is_permutation(estimate(*diagnosis_), added_, {}, &skeleton::EffectRecord::name);
        const Diagnosis& whole = result_.whole = is_known ? *diagnosis_ : body_.explained(set_, added_);
        LadderStep& last = result_.steps.back();
        last.effects = estimate(whole);
        last.material = material_of(body_.model(), whole.best());
        last.set = understood(set_, last.effects, whole.outliers.readings);
        result_.identified = skeleton_.identified(last.effects, last.set, progress_);
        last.model = result_.identified.model;
        last.comparison = compare(last.model, last.set, options_.identify.threads);
        // Where the step was fitted to all states, too, it is the model that is delivered, and so are its errors.
        if (fitted_.states.size() != set_.states.size()) return;
        last.validation_model = last.model;
        take_fitted(last.skeleton, last.comparison);
        if (last.reference) take_fitted(*last.reference, whole);
    }

    LadderBody body_;
    bool body_is_skeleton_;
    const MeasurementSet& set_;
    const LadderOptions& options_;
    const Progress& progress_;
    const Diagnosis* diagnosis_;  // of the whole set; null: there is none
    struct Fold {
        MeasurementSet fitted, held_out;
    };
    std::vector<Fold> folds_;
    MeasurementSet fitted_;           // what the steps are fitted to
    std::vector<std::string> added_;  // in the order of the steps
    LadderSkeleton skeleton_;
    Ladder result_;
};

}  // namespace

Ladder build_ladder(const skeleton::Model& model, const BodyModel& body, const MeasurementSet& set,
                    const std::vector<std::string>& effects, const LadderOptions& options, const Diagnosis* diagnosis,
                    const Progress& progress) {
    for (const std::string& name : effects) refuse_what_cannot_show(*find_effect(name), body, set);
    return LadderBuilder(model, body, set, options, diagnosis, progress).run(effects);
}

}  // namespace palpate::identify
