#include "identify/inference/maximum/calibrate.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>

#include "identify/inference/maximum/modes.h"
#include "identify/inference/problem/inform.h"
#include "identify/loading/history/load_history.h"
#include "mesh/errors.h"
#include "mesh/text/words.h"
#include "skeleton/statics/statics.h"

namespace palpate::identify {
namespace {

constexpr double hardly_any = 0.001;  // of the displacement: told as less
constexpr double first_error = 0.03;  // relative model error to begin with
constexpr double least_error = 1e-6;  // the model error never falls below it: no model is exact
// of half the chi^2: a hundredth of a posterior's sd; a tenth where another fit follows
constexpr FitOptions settled{.tolerance = 1e-4}, nearly{.tolerance = 1e-2, .final_spectrum = false};
constexpr int patience_with_memory = 6;  // fibres that begin to yield are kinks
constexpr int most_rounds = 6;           // of finer fits
constexpr double falling = 0.8;          // of the model error, after a round
constexpr int few_numbers = 4;           // data per parameter, so that a model cannot overfit
constexpr double promising = 1.5;        // of chi^2 to coordinates, that a step down to the noise may promise to leave
constexpr int states_at_first = 12;      // that choose the law, the most displaced ones

LogNormalPrior prior_round(const Eigen::VectorXd& mean, double sd) {
    return {mean, Eigen::VectorXd::Constant(mean.size(), sd), nullptr};
}

/// Relative model error that a fit leaves, as an unfitted reading would see it.
double model_error_after(const PositionDomain& domain, const FitResult& fit) {
    const double readings = domain.effective_coordinates();
    const double fitted = std::min(fit.spectrum.effective(), 0.75 * readings);
    return std::max(least_error,
                    domain.estimate_model_error(fit.prediction) * std::sqrt(readings / (readings - fitted)));
}

/// The states that moved most, in their order.
std::vector<StateReadings> most_displaced(std::vector<StateReadings> readings, int count) {
    std::erase_if(readings, [](const StateReadings& state) { return !state.informs_stiffness; });
    if (static_cast<int>(readings.size()) <= count) return readings;
    std::vector<double> displacements(readings.size());
    std::ranges::transform(readings, displacements.begin(), &StateReadings::displacement);
    std::ranges::nth_element(displacements, displacements.begin() + count - 1, std::greater{});
    std::erase_if(readings, [least = displacements[count - 1]](const auto& s) { return s.displacement < least; });
    return readings;
}

class Calibrator {
public:
    Calibrator(const skeleton::Model& model, const std::vector<StateReadings>& readings, const IdentifyOptions& options)
        : model_(model), readings_(readings), options_(options) {}

    /// A uniform fit to some of the states, under the law that explains them best where it is to be chosen.
    UniformFit initial_fit() {
        if (options_.law == LawChoice::linear) return initial_fit(skeleton::EquilibriumLaw::linear);
        if (options_.law == LawChoice::large_rotation) return initial_fit(skeleton::EquilibriumLaw::large_rotation);
        if (is_history_dependent(readings_)) {
            note("law: large rotation; by the linear one nothing yields");
            return initial_fit(skeleton::EquilibriumLaw::large_rotation);
        }

        const std::optional<UniformFit> linear = try_initial_fit(skeleton::EquilibriumLaw::linear);
        const std::optional<UniformFit> large = try_initial_fit(skeleton::EquilibriumLaw::large_rotation);
        if (!large) {
            note("law: linear; by large rotations no equilibrium was found under the measured loads");
            return linear ? *linear : initial_fit(skeleton::EquilibriumLaw::linear);
        }
        const bool is_linear = linear && linear->chi_squared < large->chi_squared;
        note(fmt::format("law: {}, chosen by fit (chi^2 {:.4g} linear, {:.4g} large rotation)",
                         is_linear ? "linear" : "large rotation", linear ? linear->chi_squared : missing,
                         large->chi_squared));
        return is_linear ? *linear : *large;
    }

    /// One multiplier a kind, round the best common factor; then the dents that explain most of what is left.
    UniformFit initial_fit(skeleton::EquilibriumLaw law) {
        // a body that yields has lived through all of them
        const std::vector<StateReadings> sample =
            is_history_dependent(readings_) ? readings_ : most_displaced(readings_, states_at_first);
        PositionDomain domain = uniform_domain(model_, law, sample);
        domain.set_model_error(first_error);
        const LogNormalPrior prior = uniform_prior(domain);
        FitResult result = fit(domain, prior, prior.mean, nearly);
        fit_dents(domain, result);
        return {law, result.theta, domain.dent(), model_error_after(domain, result), result.chi_squared};
    }

    std::optional<UniformFit> try_initial_fit(skeleton::EquilibriumLaw law) {
        try {
            return initial_fit(law);
        } catch (const SolverFailure&) {
            return std::nullopt;
        }
    }

    PositionDomain uniform_domain(const skeleton::Model& model, skeleton::EquilibriumLaw law,
                                  const std::vector<StateReadings>& readings) const {
        return {model, law, group_stiffness(model, Scope::uniform, options_.fixed), readings, options_.threads};
    }

    /// `informed`: gets the names of the parameters on which specimens inform it.
    LogNormalPrior uniform_prior(const PositionDomain& domain, std::vector<std::string>* informed = nullptr) const {
        const Eigen::VectorXd zero = Eigen::VectorXd::Zero(domain.parameters().size());
        LogNormalPrior prior = prior_round(zero.array() + domain.common_factor(zero), wide_sd);
        std::vector<std::string> names = inform(prior, domain.parameters(), options_.priors);
        if (informed) *informed = std::move(names);
        return prior;
    }

    static void fit_dents(PositionDomain& domain, FitResult& fit) {
        if (domain.fit_dents(fit.theta, fit.prediction)) fit.chi_squared = domain.chi_squared(fit.prediction);
    }

    FitResult fit(const PositionDomain& domain, const LogNormalPrior& prior, const Eigen::VectorXd& start,
                  FitOptions how) {
        if (is_history_dependent(readings_)) how.patience = patience_with_memory;
        FitResult result = fit_map(domain, prior, start, options_.threads, how);
        equilibria_ += result.evaluations * static_cast<int>(domain.states().size());
        return result;
    }

    /// The fit that leaves nothing but the noise, from one under a larger model error, and the domain without any. None
    /// where the model cannot follow so far, by what the slopes promise and then in truth, or where it has so many
    /// numbers that it could follow anything.
    std::optional<FitResult> fit_to_the_noise(PositionDomain& domain, const LogNormalPrior& prior,
                                              const FitResult& coarse) {
        if (few_numbers * domain.parameters().size() > domain.coordinates()) return std::nullopt;
        const double before = domain.log_constant();
        domain.set_model_error(least_error);
        const double sharper = std::exp(2 * (domain.log_constant() - before) / domain.coordinates());
        if (promised_chi_squared(domain, prior, coarse, sharper) > promising * domain.coordinates())
            return std::nullopt;
        const Spectrum near{sharper * coarse.spectrum.values, coarse.spectrum.vectors};
        FitOptions how = settled;
        how.near = &near;
        FitResult found = fit(domain, prior, coarse.theta, how);
        if (domain.estimate_model_error(found.prediction) > 0) return std::nullopt;
        return found;
    }

    /// A large model error may hold itself: readings weigh so little that a fit stays where it began, and the error
    /// with it. The fit under half of that error, where it leaves as much less as a round has to. None: the error is
    /// real.
    std::optional<FitResult> fit_sharper(PositionDomain& domain, const LogNormalPrior& prior, const FitResult& coarse,
                                         double model_error) {
        domain.set_model_error(0.5 * model_error);
        FitResult found = fit(domain, prior, coarse.theta, nearly);
        if (model_error_after(domain, found) < falling * model_error) return found;
        domain.set_model_error(model_error);
        return std::nullopt;
    }

    /// Puts the highest of a fit and those from other starts, where these are cheap, in its place; returns the rest.
    template <typename Starts>
    std::vector<FitResult> other_modes(const PositionDomain& domain, const LogNormalPrior& prior, FitResult& fit,
                                       const Starts& starts) {
        int evaluations = 0;
        std::vector<FitResult> modes = find_modes(domain, prior, std::move(fit), starts, options_.threads, evaluations);
        equilibria_ += evaluations * static_cast<int>(domain.states().size());
        fit = std::move(modes.front());
        modes.erase(modes.begin());
        return modes;
    }

    /// The model error that a uniform fit to some of the states leaves on all of them.
    double model_error_of(const UniformFit& fit, const PositionDomain& domain) {
        try {
            equilibria_ += static_cast<int>(domain.states().size());
            return std::max(least_error, domain.estimate_model_error(domain.predict(fit.theta, options_.threads)));
        } catch (const SolverFailure&) {  // under a load that was not among those
            return fit.model_error;
        }
    }

    void note(std::string words) { notes_.push_back(std::move(words)); }

    const skeleton::Model& model_;
    const std::vector<StateReadings>& readings_;
    const IdentifyOptions& options_;
    int equilibria_ = 0;
    std::vector<std::string> notes_;
};

}  // namespace

Calibration calibrate(const skeleton::Model& model, const std::vector<StateReadings>& readings,
                      const IdentifyOptions& options, const Progress& progress, const UniformFit* near) {
    Calibrator calibrator(model, readings, options);
    report(progress, "law", 0);
    UniformFit coarse = near ? *near : calibrator.initial_fit();

    // one multiplier a kind, with the dents and the model error that a first fit left
    report(progress, "uniform fit", 0.1);
    skeleton::Model dented = model;
    dented.dent = coarse.dent;
    PositionDomain domain = calibrator.uniform_domain(dented, coarse.law, readings);
    if (!near) coarse.model_error = calibrator.model_error_of(coarse, domain);
    domain.set_model_error(coarse.model_error);
    std::vector<std::string> informed;
    LogNormalPrior prior = calibrator.uniform_prior(domain, &informed);
    FitResult fit = calibrator.fit(domain, prior, coarse.theta, settled);
    Calibrator::fit_dents(domain, fit);
    coarse = {coarse.law, fit.theta, domain.dent(), coarse.model_error, fit.chi_squared};

    double model_error = coarse.model_error;
    std::vector<FitResult> others;
    if (options.scope == Scope::uniform) {
        others = calibrator.other_modes(domain, prior, fit, options.seed);
    } else {
        // finer, from the uniform fit
        const PositionDomain uniform = std::move(domain);
        dented.dent = uniform.dent();
        domain = PositionDomain(dented, coarse.law, group_stiffness(model, options.scope, options.fixed), readings,
                                options.threads);
        const Eigen::VectorXd start = spread_kinds(domain.parameters(), uniform.parameters(), fit.theta);
        prior = options.scope == Scope::links
                    ? LogNormalPrior{start, Eigen::VectorXd::Constant(start.size(), link_sd),
                                     smoothness_field(model, domain.parameters())}
                    : prior_round(spread_kinds(domain.parameters(), uniform.parameters(), prior.mean), wide_sd);
        std::ranges::move(inform(prior, domain.parameters(), options.priors), std::back_inserter(informed));
        domain.set_model_error(model_error);
        report(progress, "first fit", 0.2);
        fit = calibrator.fit(domain, prior, start, nearly);
        others = calibrator.other_modes(domain, prior, fit, options.seed);
        Calibrator::fit_dents(domain, fit);

        // again with the model error that it left, as long as that falls
        for (int round = 1;; ++round) {
            report(progress, "finer fit", 0.4 + 0.6 * round / most_rounds);
            double left = model_error_after(domain, fit);
            if (round < most_rounds && left > falling * model_error) {
                if (std::optional<FitResult> moved = calibrator.fit_sharper(domain, prior, fit, model_error)) {
                    fit = std::move(*moved);
                    Calibrator::fit_dents(domain, fit);
                    left = model_error_after(domain, fit);
                }
            }
            const double before = std::exchange(model_error, std::min(model_error, left));
            const bool last = round == most_rounds || model_error > falling * before;
            if (last) {
                if (std::optional<FitResult> exact = calibrator.fit_to_the_noise(domain, prior, fit)) {
                    fit = std::move(*exact);
                    model_error = least_error;
                    break;
                }
            }
            domain.set_model_error(model_error);
            FitOptions from_there = last ? settled : nearly;
            const Spectrum spectrum = std::move(fit.spectrum);
            from_there.near = &spectrum;
            fit = calibrator.fit(domain, prior, fit.theta, from_there);
            Calibrator::fit_dents(domain, fit);
            if (last) break;
        }
        std::vector<Eigen::VectorXd> starts(others.size());
        std::ranges::transform(others, starts.begin(), &FitResult::theta);
        others = calibrator.other_modes(domain, prior, fit, starts);
    }
    if (!options.priors.empty())
        calibrator.note(informed.empty()
                            ? "prior: the population's is narrower than the model's for none of these stiffnesses"
                            : fmt::format("prior: the population's for {}", mesh::listed(informed)));
    calibrator.note(fmt::format("error of the model beyond the noise: {}",
                                model_error < hardly_any ? "less than 0.1 % of the displacement"
                                                         : mesh::share_of(model_error, "the displacement")));
    if (!fit.converged) calibrator.note("the fit stopped before it converged: interpret the posterior with care");
    return {std::move(domain), std::move(prior), std::move(fit),         std::move(others),
            std::move(coarse), model_error,      calibrator.equilibria_, std::move(calibrator.notes_)};
}

skeleton::Model calibrated(const skeleton::Model& model, const Calibration& calibration) {
    skeleton::Model result = model;
    set_stiffness(result, calibration.domain.parameters().stiffness(calibration.fit.theta));
    result.law = calibration.domain.law();
    result.dent = calibration.domain.dent();
    return result;
}

}  // namespace palpate::identify
