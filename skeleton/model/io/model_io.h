#pragma once

#include <filesystem>

#include "mesh/formats/vtk/vtk_files.h"
#include "skeleton/model/model.h"

namespace palpate::skeleton {

/// Reads model.json (palpate-model/1). A model edited by hand is a valid model: what can be derived (length, inertia,
/// skin, zone, gyration) may be missing; skeleton/model.schema.json tells the rest. @throws IoError, InvalidInput
/// naming file, element and field.
Model read_model(const std::filesystem::path& file);

/// Writes model.json, whole or not at all.
void write_model(const std::filesystem::path& file, const Model& model);

/// Spheres (with radius and mass) and links (with stiffness) as one .vtp for ParaView: points carry "radius [mm]",
/// lines "elongation [N/mm]", "flexion [N*mm/rad]", "torsion [N*mm/rad]". `more`: arrays of spheres and links besides.
void write_model_vtp(const std::filesystem::path& file, const Model& model, const mesh::MeshData& more = {});

}  // namespace palpate::skeleton
