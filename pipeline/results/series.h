#pragma once

#include <filesystem>

#include "identify/compare.h"
#include "identify/identify.h"
#include "identify/set/measurement_set.h"
#include "mesh/io/vtk_files.h"
#include "skeleton/equilibrium.h"
#include "skeleton/model.h"

namespace palpate::pipeline {

/// The labelled markers of a state where they were measured, with their arrays "error [mm]" (from model to
/// measurement), "displacement [mm]" (of the model), "measured [mm]" and "marker".
struct MarkerState {
    Points measured;  // (m x 3) [mm]
    mesh::MeshData data;
};
MarkerState marker_state(const identify::MeasurementSet& set, const identify::Comparison& comparison,
                         std::size_t state);

/// Markers of every state as a series `<name>.pvd`, time = index of the state, as marker_state has them.
void write_marker_series(const std::filesystem::path& folder, const std::string& name,
                         const identify::MeasurementSet& set, const identify::Comparison& comparison);

/// The model's shape in every state as a series: its skin at rest with "displacement [mm]" to warp by, and, where the
/// set has full fields, "measured [mm]" and "error [mm]" of the skin.
void write_skin_series(const std::filesystem::path& folder, const std::string& name, const skeleton::Model& model,
                       const identify::MeasurementSet& set);

/// A skin at rest with its displacement to an equilibrium.
Points skin_displacement(const skeleton::Model& model, const skeleton::Equilibrium& equilibrium,
                         const skeleton::Load& load);

/// The particle sets as a series like figures 3 and 5 of Burion 2008: a point a particle in the plane of elongation
/// [N/mm] and flexion (scaled to the same width) per zone; "weight [-]" and every stiffness as arrays.
void write_particle_series(const std::filesystem::path& file, const identify::IdentifyResult& result);

}  // namespace palpate::pipeline
