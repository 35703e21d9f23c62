#include "pipeline/synthesis/effects/strength_trial.h"

#include <algorithm>
#include <limits>
#include <numeric>

#include "mesh/errors.h"

namespace palpate::pipeline {

StrengthTrial::StrengthTrial(const Specimen& specimen, const Plan& plan, std::size_t count,
                             const SimulationOptions& options, double noise)
    : specimen_(specimen), options_(options), noise_(noise) {
    count = std::min(count, plan.histories.size());
    histories_.assign(plan.histories.begin(), plan.histories.begin() + static_cast<std::ptrdiff_t>(count));
    near_.assign(plan.baseline.begin(), plan.baseline.begin() + static_cast<std::ptrdiff_t>(count));
    baseline_ = seen(specimen, {.setting = specimen.setting}, histories_, near_);
    bears_less_than_.assign(count, std::numeric_limits<double>::infinity());
}

std::optional<Strength> StrengthTrial::strength(const skeleton::EffectRecord& effect, double x) {
    std::vector<int> alive;
    for (int c = 0; c < static_cast<int>(histories_.size()); ++c) {
        if (x < bears_less_than_[c]) alive.push_back(c);
    }
    const auto most = static_cast<int>(histories_.size() / 4);
    const auto given_up = static_cast<int>(histories_.size() - alive.size());
    if (given_up > most) return std::nullopt;
    SimulationOptions options = options_;
    options.is_patient = false;
    options.most_failures = most - given_up;
    if (!played(effect, alive, options)) return std::nullopt;
    if (paths_.front().empty() || std::ranges::count_if(paths_, &EquilibriumPath::empty) > most) return std::nullopt;

    for (const int c : alive) {
        if (paths_[c].empty()) {
            bears_less_than_[c] = x;
        } else {
            near_[c] = paths_[c];
        }
    }
    return compared(effect);
}

Strength StrengthTrial::specified_strength(const skeleton::EffectRecord& effect) {
    std::vector<int> all(histories_.size());
    std::iota(all.begin(), all.end(), 0);
    return played(effect, all, options_) ? compared(effect) : Strength{};
}

/// Plays some of the histories. False: not even the tangent at rest is stable.
bool StrengthTrial::played(const skeleton::EffectRecord& effect, const std::vector<int>& which,
                           const SimulationOptions& options) {
    paths_ = near_;
    if (!changes_equilibrium(effect)) return true;
    std::vector<ProbeLoadHistory> histories;
    std::vector<EquilibriumPath> near;
    for (const int c : which) {
        histories.push_back(histories_[c]);
        near.push_back(near_[c]);
    }
    try {
        std::vector<EquilibriumPath> paths =
            simulate(specimen_, true_conditions(specimen_, {effect}), histories, options, &near);
        paths_.assign(histories_.size(), {});
        for (std::size_t i = 0; i < which.size(); ++i) paths_[which[i]] = std::move(paths[i]);
    } catch (const SolverFailure&) {
        return false;
    }
    return true;
}

Strength StrengthTrial::compared(const skeleton::EffectRecord& effect) const {
    const TrueConditions conditions = true_conditions(specimen_, {effect});
    Strength strength = strength_of(specimen_, baseline_, seen(specimen_, conditions, histories_, paths_));
    strength.add(conditions.scatter(noise_));
    return strength;
}

}  // namespace palpate::pipeline
