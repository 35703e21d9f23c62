#pragma once

#include <cstdint>

#include "fem/elastic_body.h"
#include "identify/measurements/measurement_set.h"
#include "mesh/progress.h"
#include "pipeline/case/probe_options.h"

namespace palpate::pipeline {

/// A reference simulation as measurements.
struct ProbedBody {
    identify::MeasurementSet set;   // markers, an unloaded state, and a state for each probe
    Eigen::MatrixXd displacements;  // full fields (3n x states) [mm], in the order of set.states
};

/// Presses, pulls and pushes sideways on a body in small strain (linear elasticity), and reads markers on its surface.
///
/// Contacts are spread over the free surface, away from the supports, each pushed in, pulled out or pushed sideways in
/// turn. Forces are scaled so that the largest displacement of each state is `displacement` of the longest side, less
/// where the pressure under the patch would pass 0.3 E. `seed` moves the contacts and draws the noise.
/// @throws InvalidInput when no surface is free to be touched.
ProbedBody probe_body(const fem::ElasticBody& body, const mesh::Surface& surface,
                      const std::vector<mesh::Region>& supports, const ProbeOptions& options, std::uint64_t seed,
                      const Progress& progress = {});

/// Contacts as probe_body places them, with forces of 1 N. @throws InvalidInput when no surface is free to be touched.
std::vector<mesh::Contact> probing_contacts(const mesh::Surface& surface, const std::vector<mesh::Region>& supports,
                                            const ProbeOptions& options, std::uint64_t seed);

/// Markers spread over the vertices that no support holds.
std::vector<identify::Marker> spread_markers(const mesh::Surface& surface, const std::vector<mesh::Region>& supports,
                                             int count);

/// Whether a probe of `run`'s own reference is kept from the fit: they are spread evenly through the set.
bool is_held_out(int probe, const ProbeOptions& options);

/// Writes the set with its full fields (field/<probe>_<time>.vtu, array "displacement").
void write_probed_body(const std::filesystem::path& folder, const ProbedBody& probed, const mesh::VolumeMesh& body);

}  // namespace palpate::pipeline
