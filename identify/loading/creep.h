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

/// The load that an elastic body would bear as a creeping one bears its own at the last stage of a probe's life: how
/// the load changed, times the compliance since then, summed over the stages. [Boltzmann's superposition]
/// @pre at least one stage; times do not fall.
std::vector<mesh::Contact> creep_equivalent_load(const std::vector<HeldLoad>& history, const fem::CreepLaw& creep);

/// The set with loads that an elastic body bears as one with these effects bears the set's own.
MeasurementSet as_elastic(const MeasurementSet& set, const fem::CreepLaw& creep);

}  // namespace palpate::identify
