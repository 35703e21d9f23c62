#include "identify/diagnosis/diagnose.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "identify/diagnosis/locate/locate.h"
#include "identify/diagnosis/locate/residual.h"
#include "identify/diagnosis/search/baselines.h"
#include "identify/diagnosis/search/crushing.h"
#include "identify/diagnosis/search/mesh_correction.h"
#include "identify/diagnosis/search/search.h"
#include "identify/diagnosis/statistics/discretisation.h"
#include "identify/diagnosis/statistics/independent_readings.h"
#include "identify/diagnosis/statistics/outliers/set_aside.h"
#include "identify/diagnosis/verdict/verdict.h"
#include "identify/effects/catalogue.h"
#include "mesh/errors.h"

namespace palpate::identify {
namespace {

constexpr const char* noise_note = "The set does not tell its noise: ";

/// The diagnosis in progress.
class DiagnosisInProgress {
public:
    DiagnosisInProgress(const BodyModel& model, const MeasurementSet& set, const DiagnoseOptions& options,
                        const Progress& progress)
        : model_(model), set_(set), options_(options), progress_(progress), baselines_(model, options) {
        result_.noise_known = all_noise_known(set);
        result_.problem = make_problem(set);
        moved_ = result_.problem.rms_mm(result_.problem.displacement());
        for (const auto& effect : catalogue()) {
            const bool known =
                std::ranges::find(options.known, effect->name(), &skeleton::EffectRecord::name) != options.known.end();
            if (!options.leaves_out(*effect) && !known) effects_.push_back(effect);
            if (known && effect->has_memory() && !result_.problem.by_stage) {
                result_.problem = result_.problem.stage_by_stage();
            }
        }
    }

    Diagnosis run() {
        if (!options_.law || *options_.law != 0) {
            result_.problem = without_crushing_probes(model_, result_.problem, options_.refit.threads, result_.notes);
        }
        const bool is_corrected = take_correction_of_neighbour();
        baselines_.fit(result_.problem, result_.notes, progress_);
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
        for (int law = 0; law < baselines_.laws(); ++law) {
            result_.law_evidence.push_back(baselines_.evidence(law) - baseline().log_evidence);
        }
        result_.independent = independent_readings(result_.problem);
        result_.large_deformation_failed = baselines_.large_deformation_failed();
        result_.false_claims = options_.false_claims;
        decide_verdict(model_, options_, result_);
        if (options_.screen && result_.verdict != Verdict::adequate) {
            tell("locating what is missing", 0.95);
            result_.missing = where_missing(model_, set_, result_, options_);
        }
        note_mesh_error();
        if (options_.refit.magnitude == MagnitudeUse::alternative && result_.best().has_known_magnitude)
            result_.notes.emplace_back(
                "Gravity was fitted with the earth's magnitude, 9.81 m/s² over all its components, as the evidence "
                "prefers that to a free magnitude; '--gravity unknown' leaves it free.");
        if (std::string note = note_of_correction(result_.problem); !note.empty())
            result_.notes.push_back(std::move(note));
        return std::move(result_);
    }

private:
    static bool all_noise_known(const MeasurementSet& set) {
        return set.position_noise || std::ranges::all_of(set.states, [](const LoadState& state) {
                   return std::ranges::none_of(state.readings, [](const Reading& r) { return std::isnan(r.sigma); });
               });
    }

    const Refit& baseline() const { return baselines_.best(); }

    void tell(const std::string& what, double share) const { report(progress_, what, share); }

    /// The mesh's error as a neighbouring fit tells it.
    bool take_correction_of_neighbour() {
        if (!options_.near || !options_.near->knows_mesh_error) return false;
        result_.problem.correct_for(discretisation_of(*options_.near->problem, result_.problem));
        return result_.problem.discretisation.size() > 0;
    }

    /// Once more where an effect explains the readings: it may move the body far from where the baseline stood.
    void correct_for_mesh_with_effect() {
        Problem& problem = result_.problem;
        if (!explained() || !shows_next_to_noise(problem, problem.discretisation)) return;
        const Refit& fit = leader()->fit;
        if (fit.explanation.has_memory()) return;
        tell("error of the mesh", 0.9);
        const Eigen::VectorXd before = problem.measured;
        correct_for_mesh(model_, problem, fit.explanation, fit.forward, options_.refit.threads);
        if (!shows_next_to_noise(problem, problem.measured - before)) return;
        baselines_.refit(problem);
        search_->refit_tried(problem);
        result_.ranking = search_->ranking();
        result_.tried = search_->tried();
    }

    /// Sensors finer than the body's mesh see its errors, which no effect explains.
    void note_mesh_error() {
        if (result_.verdict != Verdict::unexplained) return;
        const Eigen::VectorXd left_mm = result_.best().residual.cwiseProduct(result_.problem.sigma);
        const double left = result_.problem.rms_mm(left_mm);
        constexpr double most = 0.015;  // of the displacement: what meshes and their contacts may be off by
        if (left > most * moved_ || moved_ == 0) return;
        result_.notes.push_back(
            fmt::format("The residual, {:.3g} mm rms, is {:.2g} % of the displacement, which discretisation error may "
                        "explain. Shorter elements (--edge-length) reduce it; a noise of {:.3g} mm or more covers it.",
                        left, 100 * left / moved_, options_.resolution * moved_));
    }

    void estimate_noise() {
        // What is rough in the errors is noise: a missing effect is smooth from marker to marker. Errors of few
        // readings that are trusted less are as they are, a median bears them.
        Problem& problem = result_.problem;
        const Refit& fit = leading();
        const Eigen::VectorXd error_mm = fit.residual.cwiseQuotient(fit.V->weights()).cwiseProduct(problem.sigma);
        const double rough = noise_by_roughness(problem, error_mm);
        constexpr double least = 1e-12;  // [mm], where nothing moved: a sigma is above 0
        const double finest = std::max(options_.resolution * moved_, least);
        const double noise = std::max(rough, finest);
        for (Eigen::Index n = 0; n < problem.rows(); ++n) {
            if (problem.is_guessed[n]) problem.sigma[n] = noise;
        }
        std::erase_if(result_.notes, [](const std::string& note) { return note.starts_with(noise_note); });
        result_.notes.push_back(
            rough >= finest
                ? fmt::format("{}{:.3g} mm, from how errors differ between neighbouring markers.", noise_note, noise)
                : fmt::format("{}errors hardly differ between neighbouring markers, and are weighed with {:.3g} mm, "
                              "{:g} % of the displacement, which a mesh may be off by.",
                              noise_note, noise, 100 * options_.resolution));
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
        result_.notes.push_back(
            fmt::format("{} of {} readings are outliers and were set aside.", found->outliers.readings.size(), before));
        for (const ExchangedMarkers& one : found->outliers.exchanged) {
            const LoadState& state = set_.states[one.state];
            result_.notes.push_back(fmt::format(
                "In probe {} at {:g} s the markers {} and {} look exchanged: with their labels swapped both fit. Swap "
                "them in positions.csv to use their readings.",
                state.probe, state.time, label_of(set_.markers[one.markers.first]),
                label_of(set_.markers[one.markers.second])));
        }
        return true;
    }

    /// Next to a missing effect anything looks rough: before one is sought, readings are set aside only where little
    /// else is left to explain then.
    void set_plain_outliers_aside() {
        const Diagnosis before = result_;
        const Baselines baselines = baselines_;
        const double least = leaves_only_noise(baseline(), options_)
                                 ? least_next_to_noise(*single_readings_, result_.problem, options_)
                                 : 0;
        if (!set_outliers_aside(baseline(), least)) return;
        try {
            baselines_.refit(result_.problem, true);
            if (!options_.screen || leaves_only_noise(baseline(), options_)) {
                baselines_.refit(result_.problem);
                return;
            }
        } catch (const SolverFailure&) {  // to what is left nothing can be fitted
        }
        result_ = before;
        baselines_ = baselines;
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
        const Diagnosis before = result_;
        const Baselines baselines = baselines_;
        const Refit at = fit;
        if (!set_outliers_aside(at, least)) return false;
        try {
            if (leaves_only_noise(without_them(at), options_)) {
                baselines_.refit(result_.problem);
                return true;
            }
        } catch (const SolverFailure&) {  // to what is left nothing can be fitted
            baselines_ = baselines;
        }
        result_ = before;
        return false;
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
    return DiagnosisInProgress(model, set, options, progress).run();
}

}  // namespace palpate::identify
