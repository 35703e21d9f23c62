#pragma once

#include <optional>
#include <vector>

#include "pipeline/synthesis/effects/strength.h"
#include "pipeline/synthesis/loading/load_plan.h"

namespace palpate::pipeline {

/// The first histories of a plan, in which an effect is tried at one strength after the other.
class StrengthTrial {
public:
    /// `noise`: 1 sigma [mm], for outliers. Keeps no reference to the plan.
    StrengthTrial(const Specimen& specimen, const Plan& plan, std::size_t count, const SimulationOptions& options,
                  double noise);

    bool is_whole(const Plan& plan) const { return histories_.size() == plan.histories.size(); }
    Strength baseline_strength() const { return strength_of(specimen_, baseline_, baseline_); }

    /// What an effect of strength x changes over the probes that find an equilibrium; none: a quarter of them or more
    /// do not. Probes without equilibrium at a lower strength are skipped at a higher one; finally their forces may be
    /// reduced.
    std::optional<Strength> strength(const skeleton::EffectRecord& effect, double x);
    /// The same of one whose strength is specified, over all that find an equilibrium.
    Strength specified_strength(const skeleton::EffectRecord& effect);

private:
    bool played(const skeleton::EffectRecord& effect, const std::vector<int>& which, const SimulationOptions& options);
    Strength compared(const skeleton::EffectRecord& effect) const;

    const Specimen& specimen_;
    SimulationOptions options_;
    double noise_;
    std::vector<ProbeLoadHistory> histories_;
    std::vector<EquilibriumPath> near_;   // where to begin
    std::vector<EquilibriumPath> paths_;  // of the last effect
    std::vector<Points> baseline_;
    std::vector<double> bears_less_than_;  // strengths at which histories found no equilibrium
};

}  // namespace palpate::pipeline
