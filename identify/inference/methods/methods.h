#pragma once

#include "identify/inference/domains/force/force_domain.h"
#include "identify/inference/identify_result.h"
#include "identify/inference/problem/identify_options.h"
#include "identify/loading/readings.h"
#include "identify/measurements/measurement_set.h"
#include "mesh/progress.h"

namespace palpate::identify {

struct UniformFit;

inline constexpr int default_particles = 200, default_burion_particles = 600;

// What `identify` does, by method and domain; markers of fields stand among the set's.

/// Particles in the position domain, from the fit's neighbourhood.
IdentifyResult identify_tempered(const skeleton::Model& model, const MeasurementSet& set,
                                 const IdentifyOptions& options, const Progress& progress, const UniformFit* near);

/// Particles in the force domain, from the exact solution. Noise in the positions biases it: the stiffnesses are those
/// for which noisy forces are least, not those for which markers are met.
IdentifyResult identify_by_forces(const skeleton::Model& model, const MeasurementSet& set,
                                  const IdentifyOptions& options, const Progress& progress);

/// Algorithm 1 of [Burion 2008], in either domain.
IdentifyResult identify_burion2008(const skeleton::Model& model, const MeasurementSet& set,
                                   const IdentifyOptions& options, const Progress& progress);

/// Those that tell every sphere's place and turn. @throws InvalidInput naming `method` where there are none.
std::vector<MeasuredConfiguration> complete_configurations(const skeleton::Model& model, const MeasurementSet& set,
                                                           const char* method);

/// States with a load and labelled readings. @throws InvalidInput where there are none.
std::vector<StateReadings> informative_readings(const skeleton::Model& model, const MeasurementSet& set);

}  // namespace palpate::identify
