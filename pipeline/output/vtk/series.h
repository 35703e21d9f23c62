#pragma once

#include <filesystem>

#include "identify/comparison/comparison.h"
#include "identify/inference/identify_result.h"
#include "identify/measurements/measurement_set.h"
#include "mesh/formats/vtk/vtk_files.h"
#include "skeleton/model/model.h"
#include "skeleton/statics/equilibrium.h"

namespace palpate::pipeline {

/// The labelled markers of a state where they were measured, with their arrays "error [mm]" (from model to
/// measurement), "displacement [mm]" (of the model), "measured [mm]", "marker" and "coordinates": how many were read.
/// One that was not is taken to be the model's: its error is 0.
struct MarkerState {
    Points measured;  // (m x 3) [mm]
    mesh::MeshData data;
};
MarkerState marker_state(const identify::MeasurementSet& set, const identify::Comparison& comparison,
                         std::size_t state);

/// Markers of every state as a series `<name>.pvd`, time = index of the state, as marker_state has them.
void write_marker_series(const std::filesystem::path& folder, const std::string& name,
                         const identify::MeasurementSet& set, const identify::Comparison& comparison);

/// A model playing a set, four series in a folder, time = index of the state:
/// - markers.pvd as above,
/// - skin.pvd: the skin at rest with "displacement [mm]" to warp by, and, where the set has full fields, "measured
/// [mm]"
///   and "error [mm]",
/// - skeleton.pvd: spheres and links at rest as in a model's .vtp, with "displacement [mm]", "probe" and "time [s]" of
/// the
///   spheres,
/// - loads.pvd: the contacts, with "force [N]".
void write_played_series(const std::filesystem::path& folder, const skeleton::Model& model,
                         const identify::MeasurementSet& set, const identify::Comparison& comparison);

/// The particle sets as a series like figures 3 and 5 of Burion 2008: a point a particle in the plane of elongation
/// [N/mm] and flexion (scaled to the same width) per zone; "weight [-]" and every stiffness as arrays.
void write_particle_series(const std::filesystem::path& file, const identify::IdentifyResult& result);

}  // namespace palpate::pipeline
