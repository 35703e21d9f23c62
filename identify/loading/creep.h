#pragma once

#include <vector>

#include "fem/effects/effects.h"
#include "identify/measurements/measurement_set.h"

namespace palpate::identify {

/// A load as long as it acts: since the stage before it in its probe, the first since time 0.
struct HeldLoad {
    double time = 0;  // at which the body is read [s]
    std::vector<mesh::Contact> contacts;
};

/// What the load of each stage counts at the last one, on a body that creeps: J(t - t_i-1) - J(t - t_i), as it is on
/// since the stage before, the first since time 0, and off since its own; the last one is still on. Times t_i [s] of
/// the stages do not fall; J(t) = 1 + creep (1 - exp(-t / tau)). [Boltzmann 1876, superposition]
std::vector<double> superposition_weights(const std::vector<double>& times, const fem::CreepLaw& creep);

/// The load that an elastic body would bear as a creeping one bears its own at the last stage of a probe's life: the
/// superposition of the stages' loads. @pre at least one stage; times do not fall.
std::vector<mesh::Contact> creep_equivalent_load(const std::vector<HeldLoad>& history, const fem::CreepLaw& creep);

/// The set with loads that an elastic body bears as one with these effects bears the set's own.
MeasurementSet as_elastic(const MeasurementSet& set, const fem::CreepLaw& creep);

}  // namespace palpate::identify
