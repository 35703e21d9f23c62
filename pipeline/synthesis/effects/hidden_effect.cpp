#include "pipeline/synthesis/effects/hidden_effect.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "mesh/errors.h"
#include "pipeline/synthesis/effects/strength_trial.h"

namespace palpate::pipeline {
namespace {

struct SoughtStrength {
    double strength = 0;  // argument of the sampler
    Strength effect;      // on the readings
    double change() const { return effect.change; }
};

/// The strength that would move the untouched body by `aim` (rms over the markers) [mm], by its tangent.
double strength_at_rest(const Specimen& specimen, const Plan& plan, const EffectSampler& sampler, double aim) {
    const identify::BodyModel& model = *specimen.model;
    const Eigen::VectorXd& q = plan.baseline.front().front();
    const double x = 1e-3 * sampler.start;  // little enough to be in proportion
    const TrueConditions conditions = true_conditions(specimen, {sampler.at(x)});
    const Eigen::VectorXd force = model.residual(q, conditions.setting, {}) - model.residual(q, specimen.setting, {});
    const Eigen::VectorXd step = model.tangent(q, specimen.setting, {})->solve(force);
    const double small = 1e-4 * model.size() / std::max(step.cwiseAbs().maxCoeff(), 1e-300);
    const Eigen::VectorXd moved = model.advance(q, small * step, specimen.setting);
    const Points change = model.observe(moved, specimen.setting) - model.observe(q, specimen.setting);
    const double per_strength = rms({change}) / (small * x);
    return per_strength > 0 ? aim / per_strength : sampler.start;
}

/// A strength whose change lies within [least, most]; else the nearest to that. Secants in logarithms, bracketed: more
/// strength is taken to change more, and to be too much where there is no equilibrium.
SoughtStrength seek(StrengthTrial& trial, const EffectSampler& sampler, double start, double least, double most) {
    constexpr int plays = 12;
    constexpr double close = 1.06;  // strengths that need not be distinguished
    const double aim = std::sqrt(least * most);
    const auto distance = [&](const SoughtStrength& found) {
        return found.change() > 0 ? std::abs(std::log(found.change() / aim)) : std::numeric_limits<double>::infinity();
    };
    SoughtStrength best, last;
    double weak = 0, strong = std::numeric_limits<double>::infinity();  // strengths that are too little, too much
    double x = std::min(start, sampler.most);
    for (int i = 0; i < plays && strong > close * weak; ++i) {
        const std::optional<Strength> strength = trial.strength(sampler.at(x), x);
        if (!strength) {
            strong = x;
            x = weak > 0 ? std::sqrt(weak * strong) : x / 8;
            continue;
        }
        const SoughtStrength now{x, *strength};
        if (distance(now) < distance(best)) best = now;
        const bool is_weak = now.change() < least;
        if ((!is_weak && now.change() <= most) || (is_weak && x == sampler.most)) return best;
        (is_weak ? weak : strong) = x;

        double slope = sampler.slope, factor = sampler.growth;
        if (last.change() > 0 && now.change() > 0) {
            slope =
                std::clamp(std::log(now.change() / last.change()) / std::log(now.strength / last.strength), 0.2, 5.0);
        }
        if (now.change() > 0) factor = std::clamp(std::pow(aim / now.change(), 1 / slope), 1 / 8.0, sampler.growth);
        last = now;
        x = std::min(x * factor, sampler.most);
        // not where it was found to be too little or too much
        if (x <= weak || x >= strong) x = weak > 0 ? std::sqrt(weak * strong) : strong / 8;
    }
    return best;
}

}  // namespace

HiddenEffect hide(const Specimen& specimen, const Plan& plan, const std::vector<EffectSampler>& samplers,
                  const Target& target, const SimulationOptions& options) {
    constexpr std::size_t few = 7;  // histories: the untouched body, and pushes and pulls at all levels
    const StrengthTrial baseline(specimen, plan, plan.histories.size(), options, target.noise);
    const double displacement = baseline.baseline_strength().displacement;
    const double noise = 5 * target.noise, share = target.share * displacement;
    const double least = std::max(0.9 * share, noise), most = std::max(1.15 * share, 1.15 * noise);

    if (samplers.front().is_specified) {
        const skeleton::EffectRecord effect = samplers.front().at(1);
        return {effect, true, StrengthTrial(baseline).specified_strength(effect)};
    }
    const auto visibility = [&](const Strength& s) {  // 1: as asked for
        const double distinguishable = target.noise > 0 ? s.beyond / (3 * target.noise) : 1;
        return std::min({1.0, s.change / least, distinguishable});
    };
    HiddenEffect best;
    for (const EffectSampler& sampler : samplers) {
        double start = sampler.start;
        if (sampler.acts_at_rest) start = strength_at_rest(specimen, plan, sampler, std::sqrt(least * most));
        StrengthTrial some(specimen, plan, few, options, target.noise);
        if (!sampler.is_local && !some.is_whole(plan)) {
            // what is asked for of all, where it is tried
            const double ratio = some.baseline_strength().displacement / displacement;
            start = seek(some, sampler, start, least * ratio, most * ratio).strength;
            if (start == 0) continue;
        }
        StrengthTrial all(baseline);
        const SoughtStrength found = seek(all, sampler, start, least, most);
        if (found.strength > 0 && visibility(found.effect) > visibility(best.strength)) {
            best = {sampler.at(found.strength), false, found.effect};
        }
        if (visibility(best.strength) >= 1) break;
    }
    if (best.strength.change == 0) {
        throw SolverFailure(fmt::format(
            "no strength of effect '{}' has an equilibrium and is observable; specify its parameters, as in --hide {}",
            samplers.front().at(1).name, to_spec(samplers.front().at(samplers.front().start))));
    }
    return best;
}

}  // namespace palpate::pipeline
