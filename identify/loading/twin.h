#pragma once

#include <cstdint>

#include "identify/measurements/measurement_set.h"
#include "skeleton/model/model.h"

namespace palpate::identify {

/// A twin experiment: the model itself, with its stiffness and law, is the hidden truth behind the readings.
///
/// `states` tell what acts in each; their readings are made here, one of each marker, with noise of `noise` [mm] when
/// that is not zero. Surface and supports are the model's. @throws SolverFailure where a state has no equilibrium.
MeasurementSet simulate_measurements(const skeleton::Model& model, std::vector<LoadState> states,
                                     std::vector<Marker> markers, double noise = 0, std::uint64_t seed = 1);

/// Four markers on each free sphere, at the corners of a tetrahedron inside: they tell where it stands and how it is
/// turned. They are anchored at its centre.
std::vector<Marker> markers_on_spheres(const skeleton::Model& model);

}  // namespace palpate::identify
