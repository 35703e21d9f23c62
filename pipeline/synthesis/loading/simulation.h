#pragma once

#include <limits>
#include <vector>

#include "identify/effects/hiding.h"
#include "pipeline/synthesis/loading/probe_load_history.h"
#include "pipeline/synthesis/specimen.h"
#include "skeleton/effects/effect.h"

namespace palpate::pipeline {

using identify::TrueConditions;

/// The specimen with effects and faults of the measurement in force.
/// @throws InvalidInput for an effect that is not known, cannot be on this specimen, or has an impossible number.
TrueConditions true_conditions(const Specimen& specimen, const std::vector<skeleton::EffectRecord>& effects);

/// Does the body stand otherwise with this effect, or do only its readings differ?
bool changes_equilibrium(const skeleton::EffectRecord& effect);

/// How a history went: a configuration a row. None: the body found no equilibrium in some row.
using EquilibriumPath = std::vector<Eigen::VectorXd>;

struct SimulationOptions {
    bool continuous = false;  // one body goes through all histories, in order; else each finds it as new
    int threads = 1;          // changes no number
    bool is_patient = true;   // where no equilibrium is found next to `near` it is sought from rest, load by load; it
                              // takes long to learn that there is none
    int most_failures = std::numeric_limits<int>::max();  // histories without equilibrium, after which it is given up
};

/// Plays histories in a world. `near`: paths of the same histories in a similar world, where the search for equilibria
/// begins; empty ones do not matter. After a history without equilibrium a history-dependent body continues from the
/// state before it.
std::vector<EquilibriumPath> simulate(const Specimen& specimen, const TrueConditions& conditions,
                                      const std::vector<ProbeLoadHistory>& histories, const SimulationOptions& options,
                                      const std::vector<EquilibriumPath>* near = nullptr);

/// Where the markers are read, a row of the histories after the other; NaN where there is no path.
std::vector<Points> seen(const Specimen& specimen, const TrueConditions& conditions,
                         const std::vector<ProbeLoadHistory>& histories, const std::vector<EquilibriumPath>& paths);

/// How far the markers and the skin stand apart in two configurations, at most [mm].
double largest_distance(const Specimen& specimen, const Eigen::VectorXd& a, const Eigen::VectorXd& b);

}  // namespace palpate::pipeline
