#include "identify/diagnose/diagnose.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "identify/diagnose/next_probe.h"
#include "identify/diagnose/screen.h"
#include "identify/effects/catalogue.h"
#include "mesh/errors.h"

namespace palpate::identify {
namespace {

constexpr double none = -INFINITY;
constexpr const char* noise_note = "The set does not tell its noise: ";

/// A refit from another's configurations, nuisances made anew: the readings are others.
Refit refit_again(const BodyModel& model, const Problem& problem, const Refit& before, const RefitOptions& options) {
    Refit start = before;
    start.V.reset();
    return refit(model, problem, before.explanation, options, &start);
}

Explanation with_effect(const Explanation& base, const Screened& screened) {
    Explanation result = base;
    result.effects.push_back(screened.effect);
    result.values.push_back(screened.start);
    return result;
}

/// The diagnosis in progress: what is known under each law.
class Inquiry {
public:
    Inquiry(const BodyModel& model, const MeasurementSet& set, const DiagnoseOptions& options, const Progress& progress)
        : model_(model), options_(options), progress_(progress) {
        result_.noise_known = all_noise_known(set);
        result_.problem = make_problem(set, first_noise(set));
        for (const auto& effect : catalogue()) {
            const bool left_out = std::ranges::find(options.without, effect->name()) != options.without.end();
            const bool known =
                std::ranges::find(options.known, effect->name(), &skeleton::Effect::name) != options.known.end();
            if (!left_out && !known) effects_.push_back(effect);
        }
        laws_.resize(model.laws().size());
    }

    Diagnosis run() {
        leave_out_what_crushes();
        fit_baselines();
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
        judge();
        return std::move(result_);
    }

private:
    struct UnderLaw {
        std::optional<Refit> fit;        // nothing added
        std::vector<Screened> screened;  // by evidence, most first
        double evidence() const { return fit ? fit->log_evidence : none; }
        double promise() const {
            return evidence() + (screened.empty() ? 0 : std::max(0.0, screened.front().log_bayes_factor));
        }
    };

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

    int best_law() const {
        const auto best = std::ranges::max_element(laws_, {}, &UnderLaw::promise);
        return static_cast<int>(best - laws_.begin());
    }
    const Refit& baseline() const { return *std::ranges::max_element(laws_, {}, &UnderLaw::evidence)->fit; }

    void tell(const std::string& what, double share) const { report(progress_, what, share); }

    /// A pressure near Young's modulus may press the body flat: where it has no equilibrium the probe says nothing.
    void leave_out_what_crushes() {
        const int last = static_cast<int>(model_.laws().size()) - 1;
        if (options_.law && *options_.law == 0) return;
        const Explanation guess = first_guess(model_, result_.problem, 0, options_.refit.threads);
        Setting setting = guess.setting();
        const double E = model_.young(setting);
        setting.law = last;
        std::vector<char> crushed(result_.problem.actions.size(), 0);
        for (std::size_t k = 0; k < crushed.size(); ++k) {
            const Action& action = result_.problem.actions[k];
            double pressure = 0;
            for (const mesh::Contact& contact : action.contacts) {
                const double r = effective_radius(model_, contact);
                pressure = std::max(pressure, contact.force.norm() / (M_PI * r * r));
            }
            if (pressure < E) continue;
            try {
                model_.equilibrium(setting, action);
            } catch (const SolverFailure&) {
                crushed[k] = 1;
                result_.notes.push_back(
                    fmt::format("Probe {} presses with {:.3g} MPa on a body of about {:.3g} MPa and has no equilibrium "
                                "there: it is "
                                "left out.",
                                result_.problem.probe[k], pressure, E));
            }
        }
        if (std::ranges::count(crushed, 1) == 0) return;
        result_.problem = result_.problem.without_actions(crushed);
        for (std::size_t k = 0; k < result_.problem.actions.size(); ++k) {
            if (result_.problem.loaded(static_cast<int>(k))) return;
        }
        throw SolverFailure(fmt::format(
            "no probe leaves the body an equilibrium: every force presses harder than its stiffness of about {:.3g} "
            "MPa bears. Check the unit of the forces and the radii of the contacts.",
            E));
    }

    void fit_baselines() {
        std::string failure;
        const Refit* neighbour = nullptr;
        // The linear one first, then from the last, which is the best behaved of the others.
        for (std::size_t i = 0; i < laws_.size(); ++i) {
            const std::size_t law = i == 0 ? 0 : laws_.size() - i;
            if (options_.law && *options_.law != static_cast<int>(law)) continue;
            tell("baseline, law " + model_.laws()[law], 0.1 + 0.1 * static_cast<double>(i));
            Explanation start = first_guess(model_, result_.problem, static_cast<int>(law), options_.refit.threads);
            if (neighbour && neighbour->explanation.law != 0) start.theta = neighbour->explanation.theta;
            add_known(start);
            // laws of large deformation differ little: from one fit it is not far to the next
            RefitOptions how = options_.refit;
            std::optional<Refit> near;
            if (neighbour && neighbour->explanation.law != 0) {
                how.steps = std::min(how.steps, 4);
                near = *neighbour;
                near->V.reset();
            }
            try {
                laws_[law].fit = refit(model_, result_.problem, start, how, near ? &*near : nullptr);
                neighbour = &*laws_[law].fit;
            } catch (const SolverFailure& e) {
                failure = e.what();
                result_.notes.push_back(
                    fmt::format("Under the law {} the body has no equilibrium: {}", model_.laws()[law], failure));
            }
        }
        if (std::ranges::none_of(laws_, [](const UnderLaw& law) { return law.fit.has_value(); })) {
            throw SolverFailure("no law finds an equilibrium in every state: " + failure);
        }
    }

    void add_known(Explanation& explanation) const {
        for (const skeleton::Effect& known : options_.known) {
            const auto effect = find_effect(known.name);
            const auto numbers = effect->numbers(model_, result_.problem);
            if (numbers.empty()) continue;
            explanation.effects.push_back(effect);
            explanation.values.push_back(effect->values(numbers, known));
        }
    }

    void refit_baselines() {
        for (UnderLaw& law : laws_) {
            if (!law.fit) continue;
            try {
                law.fit = refit_again(model_, result_.problem, *law.fit, options_.refit);
            } catch (const SolverFailure&) {
                law.fit.reset();
            }
        }
    }

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
        refit_baselines();
    }

    /// Screens and confirms the catalogue anew.
    void inquire() {
        result_.ranking.clear();
        screen_all();
        confirm();
    }

    bool explained() const { return !result_.ranking.empty() && is_likely(result_.ranking.front()); }
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
        refit_baselines();
        return true;
    }

    /// Next to a missing effect anything looks rough: before one is sought, readings are set aside only where little
    /// else is left to explain then.
    void set_plain_outliers_aside() {
        const Diagnosis before = result_;
        const std::vector<UnderLaw> laws = laws_;
        if (!set_outliers_aside(baseline()) || !options_.screen || is_enough(baseline())) return;
        result_ = before;
        laws_ = laws;
    }

    /// Once an effect explains the rest, or nothing does, the same; undone where it does not leave mere noise.
    void set_outliers_aside_next_to_effect() {
        const Diagnosis before = result_;
        const std::vector<UnderLaw> laws = laws_;
        if (!set_outliers_aside(leading())) return;
        inquire();
        if (is_enough(leading())) return;
        result_ = before;
        laws_ = laws;
    }

    bool outliers_wanted() const { return std::ranges::find(options_.without, "outliers") == options_.without.end(); }

    void screen_all() {
        for (std::size_t law = 0; law < laws_.size(); ++law) {
            if (!laws_[law].fit) continue;
            tell("screen, law " + model_.laws()[law], 0.45 + 0.05 * static_cast<double>(law));
            laws_[law].screened =
                screen_effects(model_, result_.problem, *laws_[law].fit, effects_, options_.refit.threads);
            std::ranges::stable_sort(laws_[law].screened, std::greater{}, &Screened::log_bayes_factor);
        }
    }

    /// Refits an effect under a law; nothing where there is no equilibrium.
    std::optional<Refit> try_refit(int law, const Screened& screened) const {
        try {
            const Refit& base = *laws_[law].fit;
            return refit(model_, result_.problem, with_effect(base.explanation, screened), options_.refit, &base);
        } catch (const SolverFailure&) {
            return std::nullopt;
        }
    }

    void confirm() {
        const int law = best_law();
        const double nothing = baseline().log_evidence;
        for (const Screened& screened : laws_[law].screened) {
            Candidate candidate{.effect = screened.effect,
                                .screened = screened.log_bayes_factor,
                                .log_bayes_factor = screened.log_bayes_factor,
                                .keep = screened.keep,
                                .predicted_rms_mm = screened.predicted_rms_mm};
            const double least = std::max(options_.least_screen, 0.2 * laws_[law].screened.front().log_bayes_factor);
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
        for (std::size_t law = 0; law < laws_.size(); ++law) {
            if (static_cast<int>(law) == tried || !laws_[law].fit) continue;
            const auto screened = std::ranges::find(laws_[law].screened, candidate.effect, &Screened::effect);
            tell("refit with " + candidate.effect->name() + ", law " + model_.laws()[law], 0.9);
            const auto other = try_refit(static_cast<int>(law), *screened);
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

    void add_outliers() {
        if (!outliers_wanted()) return;
        Candidate candidate{.effect = find_effect("outliers"),
                            .screened = result_.outliers.log_bayes_factor,
                            .log_bayes_factor = result_.outliers.log_bayes_factor};
        if (!result_.outliers.readings.empty()) {
            const auto count = static_cast<double>(result_.outliers.readings.size());
            candidate.told = {"outliers",
                              {{"share", count / (count + result_.problem.readings()), "1"},
                               {"readings", count, "1"},
                               {"width", result_.outliers.width, "1"}}};
            candidate.sd = {std::sqrt(count) / (count + result_.problem.readings()), 0, 0};
            candidate.predicted_rms_mm = baseline().rms_mm;
            candidate.held_out = leave_probes_out(result_.problem, baseline());
        }
        result_.ranking.push_back(std::move(candidate));
    }

    // The four conditions of a claim.
    bool is_likely(const Candidate& c) const { return c.refit && c.log_bayes_factor >= options_.least_evidence; }
    bool is_enough(const Refit& fit) const {
        return fit.whitened_rms <= options_.most_left && fit.strain <= options_.most_strain;
    }

    void judge() {
        add_outliers();
        result_.baseline = baseline();
        result_.baseline_held_out = leave_probes_out(result_.problem, result_.baseline);
        result_.noise = result_.problem.rms_sigma();
        result_.law = result_.baseline.explanation.law;
        for (const UnderLaw& law : laws_) result_.law_evidence.push_back(law.evidence() - baseline().log_evidence);
        const bool outliers = !result_.outliers.readings.empty();

        std::vector<const Candidate*> likely;
        for (const Candidate& c : result_.ranking) {
            if (is_likely(c)) likely.push_back(&c);
        }
        std::vector<const Candidate*> alike;  // of those that explain enough, within the lead
        for (const Candidate* c : likely) {
            const double behind = likely.front()->log_bayes_factor - c->log_bayes_factor;
            const bool predicts = c->held_out->whitened_rms <= options_.most_left_held_out;
            if (is_enough(*c->refit) && predicts && behind < options_.least_lead) alike.push_back(c);
        }
        if (alike.size() > 1) {
            result_.verdict = Verdict::ambiguous;
        } else if (alike.size() == 1) {
            result_.verdict = Verdict::missing_effect;
        } else if (is_enough(result_.baseline)) {
            result_.verdict = outliers ? Verdict::missing_effect : Verdict::adequate;
        } else {
            result_.verdict = Verdict::unexplained;
        }
        if (!alike.empty()) {
            result_.explanation.push_back(alike.front()->effect->name());
            result_.law = alike.front()->refit->explanation.law;
        }
        if (outliers && result_.verdict != Verdict::unexplained) result_.explanation.emplace_back("outliers");
        if (result_.verdict == Verdict::ambiguous) {
            result_.next_probe = separate(model_, result_.problem, *alike[0], *alike[1], options_.refit.threads);
        }
        share_out_probability();
        // With an explanation its first effect leads the ranking.
        std::ranges::stable_sort(result_.ranking, std::greater{}, &Candidate::log_bayes_factor);
        if (!result_.explanation.empty()) {
            const auto first = std::ranges::find_if(
                result_.ranking, [&](const Candidate& c) { return c.effect->name() == result_.explanation.front(); });
            std::rotate(result_.ranking.begin(), first, first + 1);
        }
    }

    /// Each against the others and against nothing, all equally likely before.
    void share_out_probability() {
        double top = 0;
        for (const Candidate& c : result_.ranking) top = std::max(top, c.log_bayes_factor);
        double sum = std::exp(-top);
        for (const Candidate& c : result_.ranking) sum += std::exp(c.log_bayes_factor - top);
        for (Candidate& c : result_.ranking) c.probability = std::exp(c.log_bayes_factor - top) / sum;
    }

    const BodyModel& model_;
    const DiagnoseOptions& options_;
    const Progress& progress_;
    std::vector<std::shared_ptr<const Effect>> effects_;
    std::vector<UnderLaw> laws_;
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
