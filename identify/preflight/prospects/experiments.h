#pragma once

#include <string>
#include <vector>

#include "identify/preflight/prospects/effect_prospects.h"
#include "identify/preflight/prospects/possible_experiments.h"

namespace palpate::identify {

/// What an experiment would do for an effect.
struct ExperimentGain {
    std::string effect;
    double share_before = 0, share_after = 0;  // of cases that would be named
    double least_before = INFINITY, least_after = INFINITY;
};

/// An experiment and what it would bring.
struct ExperimentProspect {
    Experiment experiment;
    std::vector<ExperimentGain> gains = {};  // effects that need a fifth less strength at least
    std::vector<std::string> opens = {};     // effects that would then be named in half of the cases, and are not now
};

/// Each experiment added to the set, its readings of all markers as noisy as the set's, at the same guess of the
/// stiffness; those that open most come first, and those that bring nothing are left out.
/// @param noise where the set tells none [mm]
/// @param guess of the stiffness, with the body in the set's states
std::vector<ExperimentProspect> experiment_prospects(const BodyModel& model, const MeasurementSet& set, double noise,
                                                     const LinearPoint& guess,
                                                     const std::vector<EffectProspect>& before,
                                                     const std::vector<Experiment>& experiments,
                                                     const DiagnoseOptions& options);

}  // namespace palpate::identify
