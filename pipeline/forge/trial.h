#pragma once

#include <optional>
#include <vector>

#include "pipeline/forge/plan.h"
#include "pipeline/forge/strength.h"

namespace palpate::pipeline {

/// The first courses of a plan, in which an effect is tried at one strength after the other.
class Trial {
public:
    /// `noise`: 1 sigma [mm], for outliers. Keeps no reference to the plan.
    Trial(const Specimen& specimen, const Plan& plan, std::size_t count, const PlayOptions& options, double noise);

    bool is_whole(const Plan& plan) const { return courses_.size() == plan.courses.size(); }
    Strength strength_of_bare() const { return strength_of(specimen_, bare_, bare_); }

    /// What an effect of strength x changes over the probes that find an equilibrium; none: a quarter of them or more
    /// do not. Those that found none at less do not at more either; in the end they may press less.
    std::optional<Strength> strength(const skeleton::Effect& effect, double x);
    /// The same of one whose strength was told, over all that find an equilibrium.
    Strength told_strength(const skeleton::Effect& effect);

private:
    bool played(const skeleton::Effect& effect, const std::vector<int>& which, const PlayOptions& options);
    Strength compared(const skeleton::Effect& effect) const;

    const Specimen& specimen_;
    PlayOptions options_;
    double noise_;
    std::vector<Course> courses_;
    std::vector<Path> near_;   // where to begin
    std::vector<Path> paths_;  // of the last effect
    std::vector<Points> bare_;
    std::vector<double> bears_less_than_;  // strengths at which courses found no equilibrium
};

}  // namespace palpate::pipeline
