#include "identify/diagnosis/diagnose.h"

#include <fmt/format.h>

#include <algorithm>
#include <exception>
#include <functional>

#include "identify/diagnosis/diagnosis_notes.h"
#include "identify/diagnosis/locate/locate.h"
#include "identify/diagnosis/locate/residual.h"
#include "identify/diagnosis/search/baselines.h"
#include "identify/diagnosis/search/mesh_correction.h"
#include "identify/diagnosis/search/search.h"
#include "identify/diagnosis/search/states_without_equilibrium.h"
#include "identify/diagnosis/statistics/discretisation.h"
#include "identify/diagnosis/statistics/independent_readings.h"
#include "identify/diagnosis/statistics/outliers/noise_estimate.h"
#include "identify/diagnosis/statistics/outliers/set_aside.h"
#include "identify/diagnosis/verdict/verdict.h"
#include "identify/effects/catalogue.h"
#include "mesh/errors.h"

namespace palpate::identify {
namespace {

/// The diagnosis in progress.
class DiagnosisInProgress {
public:
    DiagnosisInProgress(const BodyModel& model, const MeasurementSet& set, const DiagnoseOptions& options,
                        const Progress& progress)
        : model_(model), set_(set), options_(options), progress_(progress), baselines_(model, options) {
        result_.noise_known = tells_noise(set);
        result_.problem = make_problem(set);
        moved_ = result_.problem.rms_mm(result_.problem.displacement());
        for (const auto& effect : catalogue()) {
            const bool known =
                std::ranges::find(options.known, effect->name(), &skeleton::EffectRecord::name) != options.known.end();
            if (!options.leaves_out(*effect) && !known) effects_.push_back(effect);
            if (known && effect->has_memory() && !result_.problem.by_stage)
                result_.problem = result_.problem.stage_by_stage();
        }
    }

    Diagnosis run() {
        const bool is_corrected = take_correction_of_neighbour();
        fit_baselines();
        if (!is_corrected && options_.refit.correct_for_mesh) {
            tell("error of the mesh", 0.35);
            correct_baselines_for_mesh(model_, result_.problem, baselines_, options_.refit.threads);
        }
        if (!result_.noise_known) estimate_noise();
        set_plain_outliers_aside();
        if (options_.screen) {
            // Evidence of fits that leave noise may differ by some tens for nuisances that were taken elsewhere: the
            // baseline's are taken where it stands, as those of a fit with an effect are.
            if (leaves_only_noise(baseline(), options_)) baselines_.refit(result_.problem, true);
            search_and_refit();
            if (!result_.noise_known && explained()) {
                estimate_noise();
                search_and_refit();
            }
            correct_for_mesh_with_effect();
        }
        result_.baseline = baseline();
        result_.baseline_held_out = leave_probes_out(result_.problem, result_.baseline);
        result_.noise = result_.problem.rms_sigma();
        for (int law = 0; law < baselines_.laws(); ++law)
            result_.law_evidence.push_back(baselines_.evidence(law) - baseline().log_evidence);
        result_.independent = independent_readings(result_.problem);
        result_.large_deformation_failed = baselines_.large_deformation_failed();
        result_.false_claims = options_.false_claims;
        decide_verdict(model_, options_, result_);
        if (options_.screen && result_.verdict != Verdict::adequate) {
            tell("locating what is missing", 0.95);
            result_.missing = where_missing(model_, set_, result_, options_);
        }
        note_limits(options_, moved_, result_);
        return std::move(result_);
    }

private:
    const Refit& baseline() const { return baselines_.best(); }

    void tell(const std::string& what, double share) const { report(progress_, what, share); }

    /// Without the states that tools cannot be in, where with them no law, or none of large deformation, has
    /// equilibria.
    void fit_baselines() {
        std::exception_ptr failure;
        std::vector<std::string> of_laws;
        const auto fit = [&] {
            const int threads = options_.refit.threads;
            if (!options_.law || *options_.law != 0)
                result_.problem = without_crushing_probes(model_, result_.problem, threads, result_.notes);
            of_laws.clear();
            baselines_.fit(result_.problem, of_laws, progress_);
        };
        try {
            fit();
        } catch (const SolverFailure&) {
            failure = std::current_exception();
        }
        if (failure || baselines_.large_deformation_failed()) {
            const std::size_t before = result_.notes.size();
            result_.problem = without_unreached_tools(model_, result_.problem, options_.refit.threads, result_.notes);
            if (result_.notes.size() > before)
                fit();
            else if (failure)
                std::rethrow_exception(failure);
        }
        result_.notes.insert(result_.notes.end(), of_laws.begin(), of_laws.end());
    }

    /// The mesh's error as a neighbouring fit tells it.
    bool take_correction_of_neighbour() {
        if (!options_.near || !options_.near->knows_mesh_error) return false;
        result_.problem.correct_for(discretisation_of(*options_.near->problem, result_.problem));
        return result_.problem.discretisation.size() > 0;
    }

    /// Once more where an effect explains the readings: it may move the body far from where the baseline stood.
    void correct_for_mesh_with_effect() {
        Problem& problem = result_.problem;
        if (!explained() || !shows_next_to(leader()->fit, problem, problem.discretisation)) return;
        const Refit& fit = leader()->fit;
        if (fit.explanation.has_memory()) return;
        tell("error of the mesh", 0.9);
        const Eigen::VectorXd before = problem.measured;
        correct_for_mesh(model_, problem, fit.explanation, fit.forward, options_.refit.threads);
        if (!shows_next_to(fit, problem, problem.measured - before)) return;
        baselines_.refit(problem);
        search_->refit_tried(problem);
        result_.ranking = search_->ranking();
        result_.tried = search_->tried();
    }

    void estimate_noise() {
        estimate_noise_from(leading(), moved_, options_.resolution, result_.problem, result_.notes);
        baselines_.refit(result_.problem);
    }

    /// Seeks effects in the catalogue, first by themselves, then several together. Outliers are looked for next to the
    /// best single one: several effects would bend to them.
    void search_and_refit() {
        seek(&Search::single_effects);
        if (set_outliers_aside_next_to_effect()) seek(&Search::single_effects);
        seek(&Search::put_together);
        if (!leaves_only_noise(leading(), options_) && set_outliers_aside_next_to_effect()) {
            seek(&Search::single_effects);
            seek(&Search::put_together);
        }
        seek_last_resorts();
    }

    /// What no named effect explains may be the stiffness of single parts: where what is left is likelier a place that
    /// is softer or stiffer, alike in all states, than a force or a fault of the readings.
    void seek_last_resorts() {
        const bool has_any = std::ranges::any_of(
            effects_, [](const auto& effect) { return effect->is_last_resort() || effect->may_repeat(); });
        if (!has_any || leaves_only_noise(baseline(), options_) || search_->has_claim()) return;
        const auto left = locate_missing(model_, result_.problem, leading(), options_.refit.threads);
        if (!left || left->kind != SourceKind::stiffness) return;
        const SourceTerm& likeliest = left->likeliest();
        if (likeliest.form == SourceForm::softening && likeliest.law == SourceLaw::constant)
            seek(&Search::last_resorts);
    }

    void seek(void (Search::*what)()) {
        if (what == &Search::single_effects) {
            search_ = std::make_unique<Search>(model_, result_.problem, baselines_, effects_, options_, progress_);
        }
        ((*search_).*what)();
        result_.ranking = search_->ranking();
        result_.tried = search_->tried();
    }

    const FittedExplanation* leader() const {
        const auto found = std::ranges::max_element(result_.tried, {}, &FittedExplanation::log_bayes_factor);
        return found == result_.tried.end() || !is_claimable(*found, options_) ? nullptr : &*found;
    }
    bool explained() const { return leader() != nullptr; }
    const Refit& leading() const { return explained() ? leader()->fit : baseline(); }

    /// Readings that are off by themselves, as a fit sees them; true where some were set aside.
    bool set_outliers_aside(const Refit& fit, double least) {
        if (options_.leaves_out(*single_readings_) || !result_.outliers.readings.empty()) return false;
        tell(single_readings_->name(), 0.4);
        const auto found = single_readings_off(result_.problem, fit, std::max(least, options_.least_outliers));
        if (!found) return false;
        const int before = result_.problem.readings();
        result_.outliers = found->outliers;
        result_.problem = result_.problem.with_rows(found->others);
        note_outliers(set_, before, result_);
        return true;
    }

    /// The same, kept only where `is_right` then and the baselines can be fitted to what is left; else all is as
    /// before.
    bool set_outliers_aside_if(const Refit& fit, double least, const std::function<bool()>& is_right) {
        const Diagnosis before = result_;
        const Baselines baselines = baselines_;
        if (!set_outliers_aside(fit, least)) return false;
        try {
            if (is_right()) {
                baselines_.refit(result_.problem);
                return true;
            }
        } catch (const SolverFailure&) {  // to what is left nothing can be fitted
        }
        result_ = before;
        baselines_ = baselines;
        return false;
    }

    /// Next to a missing effect anything looks rough: before one is sought, readings are set aside only where little
    /// else is left to explain then.
    void set_plain_outliers_aside() {
        const double least = leaves_only_noise(baseline(), options_)
                                 ? least_next_to_noise(*single_readings_, result_.problem, options_)
                                 : 0;
        set_outliers_aside_if(baseline(), least, [&] {
            baselines_.refit(result_.problem, true);
            return !options_.screen || leaves_only_noise(baseline(), options_);
        });
    }

    /// Once an effect explains the rest, or nothing does, the same; only where noise is left then. True where some were
    /// set aside.
    bool set_outliers_aside_next_to_effect() {
        if (!explained()) return set_outliers_aside_next_to(baseline(), 0);
        if (leaves_only_noise(leader()->fit, options_)) {
            return set_outliers_aside_next_to(
                leader()->fit, least_next_to_effect(*single_readings_, *leader(), result_.problem, options_));
        }
        // Wrong readings favour what bends to them: another effect may lead without them.
        std::vector<FittedExplanation> rivals;
        for (const FittedExplanation& one : result_.tried) {
            constexpr double of_leader = 0.5;  // what explains less will not lead; each costs a fit
            if (one.log_bayes_factor > of_leader * leader()->log_bayes_factor) rivals.push_back(one);
        }
        std::ranges::stable_sort(rivals, std::greater{}, &FittedExplanation::log_bayes_factor);
        return std::ranges::any_of(
            rivals, [&](const FittedExplanation& one) { return set_outliers_aside_next_to(one.fit, 0); });
    }

    bool set_outliers_aside_next_to(const Refit& fit, double least) {
        const Refit at = fit;
        return set_outliers_aside_if(at, least, [&] { return leaves_only_noise(without_them(at), options_); });
    }

    /// A fit once more, to the readings that are left.
    Refit without_them(const Refit& fit) const {
        Refit start = fit;
        start.V.reset();
        const bool in_stages = fit.explanation.has_memory() && !result_.problem.by_stage;
        return refit(model_, in_stages ? result_.problem.stage_by_stage() : result_.problem, fit.explanation,
                     options_.refit, &start);
    }

    const std::shared_ptr<const EffectHypothesis> single_readings_ = effect_of_single_readings();
    const BodyModel& model_;
    const MeasurementSet& set_;
    const DiagnoseOptions& options_;
    const Progress& progress_;
    std::vector<std::shared_ptr<const EffectHypothesis>> effects_;
    Baselines baselines_;
    std::unique_ptr<Search> search_;
    Diagnosis result_;
    double moved_ = 0;  // readings from rest, rms [mm]
};

}  // namespace

Diagnosis diagnose(const BodyModel& model, const MeasurementSet& set, const DiagnoseOptions& options,
                   const Progress& progress) {
    options.validate();
    const auto laws = static_cast<int>(model.laws().size());
    if (options.law && (*options.law < 0 || *options.law >= laws)) {
        throw InvalidInput(fmt::format("law is {}; allowed: 0 to {}", *options.law, laws - 1));
    }
    // Its parts come back where they were before, with an effect or without readings: how much is done stays.
    double done = 0;
    const Progress onward = [&](std::string_view what, double share) {
        done = std::max(done, share);
        report(progress, what, done);
    };
    return DiagnosisInProgress(model, set, options, onward).run();
}

}  // namespace palpate::identify
