#include "identify/fit/calibrate.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "identify/fit/lived.h"
#include "mesh/errors.h"
#include "skeleton/statics.h"

namespace palpate::identify {
namespace {

constexpr double wide_sd = 3;         // of ln multipliers that many links share
constexpr double link_sd = 0.7;       // of ln of one link's, round the uniform fit
constexpr double first_error = 0.03;  // relative model error to begin with
constexpr double least_error = 1e-4;  // the model error never falls below it: no model is exact
constexpr double settled = 1e-4;      // of half the chi^2: a hundredth of a posterior's sd
constexpr double nearly = 1e-2;       // the same, of a fit that another follows
constexpr int steps_with_memory = 8;  // of a fit whose states are lived through
constexpr int states_for_law = 12;    // that choose the law, the most displaced ones

LogNormalPrior prior_round(const Eigen::VectorXd& mean, double sd) {
    return {mean, Eigen::VectorXd::Constant(mean.size(), sd)};
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
    std::erase_if(readings, [](const StateReadings& state) { return !state.tells_stiffness; });
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

    skeleton::Law choose_law() {
        if (options_.law == LawChoice::linear) return skeleton::Law::linear;
        if (options_.law == LawChoice::large_rotation) return skeleton::Law::large_rotation;
        if (remembers(readings_)) {
            note("law: large rotation; by the linear one nothing yields");
            return skeleton::Law::large_rotation;
        }

        const std::vector<StateReadings> sample = most_displaced(readings_, states_for_law);
        const auto chi_squared = [&](skeleton::Law law) -> std::optional<double> {
            PositionDomain domain(model_, law, group_stiffness(model_, Scope::uniform, options_.fixed), sample,
                                  options_.threads);
            try {
                return first_uniform_fit(domain).fit.chi_squared;
            } catch (const SolverFailure&) {
                return std::nullopt;
            }
        };
        const std::optional<double> linear = chi_squared(skeleton::Law::linear);
        const std::optional<double> large = chi_squared(skeleton::Law::large_rotation);
        if (!large) {
            note("law: linear; by large rotations no equilibrium was found under the measured loads");
            return skeleton::Law::linear;
        }
        const bool is_linear = linear && *linear < *large;
        note(fmt::format("law: {}, chosen by fit (chi^2 {:.4g} linear, {:.4g} large rotation)",
                         is_linear ? "linear" : "large rotation", linear.value_or(missing), *large));
        return is_linear ? skeleton::Law::linear : skeleton::Law::large_rotation;
    }

    struct Stage {
        LogNormalPrior prior;
        FitResult fit;
        double model_error;
    };

    /// One multiplier a kind, round the best common factor; then the dents that explain most of what is left.
    Stage first_uniform_fit(PositionDomain& domain) {
        domain.set_model_error(first_error);
        const Eigen::VectorXd zero = Eigen::VectorXd::Zero(domain.parameters().size());
        const Eigen::VectorXd center = zero.array() + domain.common_factor(zero);
        const LogNormalPrior prior = prior_round(center, wide_sd);
        Stage stage{prior, fit(domain, prior, center, nearly), first_error};
        fit_dents(domain, stage.fit);
        return stage;
    }

    /// Again, with the dents and the model error that the first fit left.
    Stage second_uniform_fit(PositionDomain& domain, const Stage& first) {
        const double model_error = model_error_after(domain, first.fit);
        domain.set_model_error(model_error);
        const Eigen::VectorXd zero = Eigen::VectorXd::Zero(domain.parameters().size());
        const Eigen::VectorXd center = zero.array() + domain.common_factor(zero);
        const LogNormalPrior prior = prior_round(center, wide_sd);
        Stage stage{prior, fit(domain, prior, first.fit.theta, settled), model_error};
        fit_dents(domain, stage.fit);
        return stage;
    }

    static void fit_dents(PositionDomain& domain, FitResult& fit) {
        if (domain.fit_dents(fit.theta, fit.prediction)) fit.chi_squared = domain.chi_squared(fit.prediction);
    }

    FitResult fit(const PositionDomain& domain, const LogNormalPrior& prior, const Eigen::VectorXd& start,
                  double tolerance) {
        FitOptions how{.tolerance = tolerance};
        // Slopes leave out what the states before would have left: the last digits take long.
        if (remembers(readings_)) how.iterations = std::min(how.iterations, steps_with_memory);
        FitResult result = fit_map(domain, prior, start, options_.threads, how);
        equilibria_ += result.evaluations * static_cast<int>(domain.states().size());
        return result;
    }

    void note(std::string words) { notes_.push_back(std::move(words)); }

    const skeleton::Model& model_;
    const std::vector<StateReadings>& readings_;
    const IdentifyOptions& options_;
    int equilibria_ = 0;
    std::vector<std::string> notes_;
};

/// The value of each kind of stiffness in a uniform fit, for the parameters of a finer scope.
Eigen::VectorXd spread_kinds(const Parameters& fine, const Parameters& uniform, const Eigen::VectorXd& theta) {
    Eigen::VectorXd result(fine.size());
    for (int p = 0; p < fine.size(); ++p) {
        const auto same = std::ranges::find(uniform.list, fine.list[p].kind, &Parameter::kind);
        result[p] = theta[same - uniform.list.begin()];
    }
    return result;
}

}  // namespace

Calibration calibrate(const skeleton::Model& model, const std::vector<StateReadings>& readings,
                      const IdentifyOptions& options, const Progress& progress) {
    Calibrator calibrator(model, readings, options);
    report(progress, "law", 0);
    const skeleton::Law law = calibrator.choose_law();

    // one multiplier a kind; a second time with the model error that the first fit left
    report(progress, "uniform fit", 0.1);
    PositionDomain uniform(model, law, group_stiffness(model, Scope::uniform, options.fixed), readings,
                           options.threads);
    Calibrator::Stage stage = calibrator.second_uniform_fit(uniform, calibrator.first_uniform_fit(uniform));
    double model_error = stage.model_error;

    PositionDomain domain = uniform;
    LogNormalPrior prior = stage.prior;
    FitResult fit = std::move(stage.fit);
    if (options.scope != Scope::uniform) {
        // finer, from the uniform fit; again twice
        skeleton::Model dented = model;
        dented.dent = uniform.dent();
        domain = PositionDomain(dented, law, group_stiffness(model, options.scope, options.fixed), readings,
                                options.threads);
        const Eigen::VectorXd start = spread_kinds(domain.parameters(), uniform.parameters(), fit.theta);
        prior = options.scope == Scope::links
                    ? prior_round(start, link_sd)
                    : prior_round(spread_kinds(domain.parameters(), uniform.parameters(), prior.mean), wide_sd);
        domain.set_model_error(model_error);
        report(progress, "first fit", 0.2);
        fit = calibrator.fit(domain, prior, start, nearly);
        Calibrator::fit_dents(domain, fit);
        model_error = std::min(model_error, model_error_after(domain, fit));
        report(progress, "second fit", 0.6);
        domain.set_model_error(model_error);
        fit = calibrator.fit(domain, prior, fit.theta, settled);
        Calibrator::fit_dents(domain, fit);
    } else {
        domain.set_model_error(model_error);
    }
    calibrator.note(
        fmt::format("relative model error: {:.2g} % of the displacement, beyond the noise", 100 * model_error));
    if (!fit.converged) calibrator.note("the fit stopped before it settled: take the posterior with care");
    return {std::move(domain), std::move(prior),       std::move(fit),
            model_error,       calibrator.equilibria_, std::move(calibrator.notes_)};
}

skeleton::Model calibrated(const skeleton::Model& model, const Calibration& calibration) {
    skeleton::Model result = model;
    set_stiffness(result, calibration.domain.parameters().stiffness(calibration.fit.theta));
    result.law = calibration.domain.law();
    result.dent = calibration.domain.dent();
    return result;
}

}  // namespace palpate::identify
