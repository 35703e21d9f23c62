#include "identify/diagnose/diagnose.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "identify/diagnose/baselines.h"
#include "identify/diagnose/crushing.h"
#include "identify/diagnose/judge.h"
#include "identify/diagnose/screen.h"
#include "identify/effects/catalogue.h"
#include "mesh/errors.h"

namespace palpate::identify {
namespace {

constexpr const char* noise_note = "The set does not tell its noise: ";

Explanation with_effect(const Explanation& base, const Screened& screened) {
    Explanation result = base;
    result.effects.push_back(screened.effect);
    result.values.push_back(screened.start);
    return result;
}

/// The diagnosis in progress.
class Inquiry {
public:
    Inquiry(const BodyModel& model, const MeasurementSet& set, const DiagnoseOptions& options, const Progress& progress)
        : model_(model), options_(options), progress_(progress), baselines_(model, options) {
        result_.noise_known = all_noise_known(set);
        result_.problem = make_problem(set, first_noise(set));
        for (const auto& effect : catalogue()) {
            const bool left_out = std::ranges::find(options.without, effect->name()) != options.without.end();
            const bool known =
                std::ranges::find(options.known, effect->name(), &skeleton::Effect::name) != options.known.end();
            if (!left_out && !known) effects_.push_back(effect);
        }
    }

    Diagnosis run() {
        if (!options_.law || *options_.law != 0) {
            result_.problem = without_crushing_probes(model_, result_.problem, options_.refit.threads, result_.notes);
        }
        baselines_.fit(result_.problem, result_.notes, progress_);
        if (!result_.noise_known) estimate_noise();
        set_plain_outliers_aside();
        if (options_.screen) {
            inquire();
            if (!result_.noise_known && explained()) {
                estimate_noise();
                inquire();
            }
            set_outliers_aside_next_to_effect();
        }
        result_.baseline = baseline();
        result_.baseline_held_out = leave_probes_out(result_.problem, result_.baseline);
        result_.noise = result_.problem.rms_sigma();
        for (int law = 0; law < baselines_.laws(); ++law) {
            result_.law_evidence.push_back(baselines_.evidence(law) - baseline().log_evidence);
        }
        judge(model_, options_, result_);
        return std::move(result_);
    }

private:
    static bool all_noise_known(const MeasurementSet& set) {
        return set.position_noise || std::ranges::all_of(set.states, [](const LoadState& state) {
                   return std::ranges::none_of(state.readings, [](const Reading& r) { return std::isnan(r.sigma); });
               });
    }

    /// A hundredth of how far the markers move, to begin with where nobody tells the noise [mm].
    static double first_noise(const MeasurementSet& set) {
        const Eigen::VectorXd u = make_problem(set, 1).displacement();
        return std::max(0.01 * std::sqrt(u.squaredNorm() / static_cast<double>(u.size())), 1e-12);
    }

    /// The law under which the best effect, by the screen, promises most.
    int most_promising_law() const {
        int best = 0;
        double most = -INFINITY;
        for (int law = 0; law < baselines_.laws(); ++law) {
            const double more = screened_[law].empty() ? 0 : std::max(0.0, screened_[law].front().log_bayes_factor);
            if (baselines_.evidence(law) + more > most) {
                most = baselines_.evidence(law) + more;
                best = law;
            }
        }
        return best;
    }
    const Refit& baseline() const { return baselines_.best(); }

    void tell(const std::string& what, double share) const { report(progress_, what, share); }

    void estimate_noise() {
        // What is rough in the errors is noise: a missing effect is smooth from marker to marker.
        Problem& problem = result_.problem;
        const Eigen::VectorXd error_mm = leading().residual.cwiseProduct(problem.sigma);
        const double noise = std::max(noise_by_roughness(problem, error_mm), 1e-12);
        for (Eigen::Index n = 0; n < problem.rows(); ++n) {
            if (problem.is_guessed[n]) problem.sigma[n] = noise;
        }
        std::erase_if(result_.notes, [](const std::string& note) { return note.starts_with(noise_note); });
        result_.notes.push_back(
            fmt::format("{}{:.3g} mm, from how errors differ between neighbouring markers.", noise_note, noise));
        baselines_.refit(result_.problem);
    }

    /// Screens and confirms the catalogue anew.
    void inquire() {
        result_.ranking.clear();
        screen_all();
        confirm();
    }

    bool explained() const { return !result_.ranking.empty() && is_likely(result_.ranking.front(), options_); }
    const Refit& leading() const { return explained() ? *result_.ranking.front().refit : baseline(); }

    /// Readings that are off by themselves, as a fit sees them; true where some were set aside.
    bool set_outliers_aside(const Refit& fit) {
        if (!outliers_wanted() || !result_.outliers.readings.empty()) return false;
        tell("outliers", 0.4);
        const Outliers found = find_outliers(result_.problem, fit.residual);
        if (found.log_bayes_factor < options_.least_evidence) return false;
        result_.outliers = found;
        result_.outliers.readings.clear();
        const int before = result_.problem.readings();
        const std::vector<char> keep = rows_without(result_.problem, found.readings);
        for (std::size_t n = 0; n < keep.size(); ++n) {
            const int number = result_.problem.set_reading[n];
            std::vector<int>& numbers = result_.outliers.readings;
            if (!keep[n] && (numbers.empty() || numbers.back() != number)) numbers.push_back(number);
        }
        result_.problem = result_.problem.with_rows(keep);
        result_.notes.push_back(
            fmt::format("{} of {} readings are off by themselves and were set aside.", found.readings.size(), before));
        baselines_.refit(result_.problem);
        return true;
    }

    /// Next to a missing effect anything looks rough: before one is sought, readings are set aside only where little
    /// else is left to explain then.
    void set_plain_outliers_aside() {
        const Diagnosis before = result_;
        const Baselines baselines = baselines_;
        if (!set_outliers_aside(baseline()) || !options_.screen || is_enough(baseline(), options_)) return;
        result_ = before;
        baselines_ = baselines;
    }

    /// Once an effect explains the rest, or nothing does, the same; undone where it does not leave mere noise.
    void set_outliers_aside_next_to_effect() {
        const Diagnosis before = result_;
        const Baselines baselines = baselines_;
        if (!set_outliers_aside(leading())) return;
        inquire();
        if (is_enough(leading(), options_)) return;
        result_ = before;
        baselines_ = baselines;
    }

    bool outliers_wanted() const { return std::ranges::find(options_.without, "outliers") == options_.without.end(); }

    void screen_all() {
        screened_.assign(baselines_.laws(), {});
        for (int law = 0; law < baselines_.laws(); ++law) {
            if (!baselines_.under(law)) continue;
            tell("screen, law " + model_.laws()[law], 0.45 + 0.05 * law);
            screened_[law] =
                screen_effects(model_, result_.problem, *baselines_.under(law), effects_, options_.refit.threads);
            std::ranges::stable_sort(screened_[law], std::greater{}, &Screened::log_bayes_factor);
        }
    }

    /// Refits an effect under a law; nothing where there is no equilibrium.
    std::optional<Refit> try_refit(int law, const Screened& screened) const {
        try {
            const Refit& base = *baselines_.under(law);
            return refit(model_, result_.problem, with_effect(base.explanation, screened), options_.refit, &base);
        } catch (const SolverFailure&) {
            return std::nullopt;
        }
    }

    void confirm() {
        const int law = most_promising_law();
        const double nothing = baseline().log_evidence;
        for (const Screened& screened : screened_[law]) {
            Candidate candidate{.effect = screened.effect,
                                .screened = screened.log_bayes_factor,
                                .log_bayes_factor = screened.log_bayes_factor,
                                .keep = screened.keep,
                                .predicted_rms_mm = screened.predicted_rms_mm};
            const double least = std::max(options_.least_screen, 0.2 * screened_[law].front().log_bayes_factor);
            if (std::ssize(result_.ranking) < options_.refits && screened.log_bayes_factor >= least) {
                tell("refit with " + screened.effect->name(), 0.6 + 0.08 * static_cast<double>(result_.ranking.size()));
                candidate.refit = try_refit(law, screened);
                if (candidate.refit) candidate.log_bayes_factor = candidate.refit->log_evidence - nothing;
            }
            result_.ranking.push_back(std::move(candidate));
        }
        std::ranges::stable_sort(result_.ranking, std::greater{}, &Candidate::log_bayes_factor);
        // The law goes with the effect: the two that lead are tried under the others too.
        for (std::size_t c = 0; c < std::min<std::size_t>(2, result_.ranking.size()); ++c) {
            if (result_.ranking[c].refit) try_other_laws(result_.ranking[c], law);
        }
        std::ranges::stable_sort(result_.ranking, std::greater{}, &Candidate::log_bayes_factor);
        for (Candidate& candidate : result_.ranking) conclude(candidate);
    }

    void try_other_laws(Candidate& candidate, int tried) const {
        const double nothing = baseline().log_evidence;
        for (int law = 0; law < baselines_.laws(); ++law) {
            if (law == tried || !baselines_.under(law)) continue;
            const auto screened = std::ranges::find(screened_[law], candidate.effect, &Screened::effect);
            tell("refit with " + candidate.effect->name() + ", law " + model_.laws()[law], 0.9);
            const auto other = try_refit(law, *screened);
            if (!other || other->log_evidence <= candidate.refit->log_evidence) continue;
            candidate.refit = other;
            candidate.log_bayes_factor = other->log_evidence - nothing;
            candidate.predicted_rms_mm = screened->predicted_rms_mm;
            candidate.keep = screened->keep;
        }
    }

    void conclude(Candidate& candidate) const {
        if (!candidate.refit) return;
        const Refit& fit = *candidate.refit;
        candidate.held_out = leave_probes_out(result_.problem, fit);
        const Eigen::VectorXd& v = fit.explanation.values.back();
        candidate.told = candidate.effect->told(fit.numbers.back(), v);
        // told(v) is a number by number map: its slope carries the fit's sd over
        const Eigen::VectorXd sd = fit.covariance.diagonal().tail(v.size()).cwiseSqrt();
        constexpr double h = 1e-6;
        const skeleton::Effect ahead = candidate.effect->told(fit.numbers.back(), v.array() + h);
        for (std::size_t j = 0; j < candidate.told.parameters.size(); ++j) {
            const double slope = (ahead.parameters[j].value - candidate.told.parameters[j].value) / h;
            candidate.sd.push_back(std::abs(slope) * sd[static_cast<Eigen::Index>(j)]);
        }
    }

    const BodyModel& model_;
    const DiagnoseOptions& options_;
    const Progress& progress_;
    std::vector<std::shared_ptr<const Effect>> effects_;
    Baselines baselines_;
    std::vector<std::vector<Screened>> screened_;  // under each law, by evidence, most first
    Diagnosis result_;
};

}  // namespace

void DiagnoseOptions::validate() const {
    for (const std::string& name : without) find_effect(name);
    const auto above = [](const char* name, double value) {
        if (!(value > 0)) throw InvalidInput(fmt::format("{} is {}; it must be above 0", name, value));
    };
    above("most_left", most_left);
    above("most_left_held_out", most_left_held_out);
    above("most_strain", most_strain);
    if (refit.steps < 1) throw InvalidInput(fmt::format("refit.steps is {}; allowed: 1 and more", refit.steps));
    if (refits < 1) throw InvalidInput(fmt::format("refits is {}; allowed: 1 and more", refits));
}

const Refit& Diagnosis::best() const {
    if (verdict == Verdict::missing_effect || verdict == Verdict::ambiguous) {
        if (ranking.front().refit) return *ranking.front().refit;
    }
    return baseline;
}

Diagnosis diagnose(const BodyModel& model, const MeasurementSet& set, const DiagnoseOptions& options,
                   const Progress& progress) {
    options.validate();
    const auto laws = static_cast<int>(model.laws().size());
    if (options.law && (*options.law < 0 || *options.law >= laws)) {
        throw InvalidInput(fmt::format("law is {}; allowed: 0 to {}", *options.law, laws - 1));
    }
    return Inquiry(model, set, options, progress).run();
}

}  // namespace palpate::identify
