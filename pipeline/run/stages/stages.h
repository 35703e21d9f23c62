#pragma once

#include <nlohmann/json.hpp>
#include <vector>

#include "identify/measurements/measurement_set.h"
#include "mesh/core/material_region.h"
#include "mesh/core/surface.h"
#include "mesh/core/volume_mesh.h"
#include "pipeline/case/subject/subject.h"
#include "pipeline/command_line/terminal/outcome.h"
#include "pipeline/run/folder/run_folder.h"
#include "skeleton/model/model.h"

namespace palpate::pipeline::commands {

class RunDiagnosis;

/// A run and what its stages have come to so far.
struct Job {
    Common common;
    Subject subject;
    RunFolder folder;
    mesh::VolumeMesh body{};
    std::vector<int> element_regions{};  // of the body; empty: it is of one material
    mesh::Surface surface{};
    skeleton::Model model{};
    identify::MeasurementSet set{}, fit{}, held_out{};  // as the run takes them; what is fitted, and what judges it
};

// The stages, in the order in which they run. Each leaves its result as a file and in the job; a stage that was
// finished before is read back instead.

/// `body`, `element_regions` and `surface`; nothing where a model is given, but for the surface's file.
void mesh_stage(Job& job);

/// `model`: built from the body, or as given.
void skeleton_stage(Job& job);

/// `set`, `fit` and `held_out`: of the measurements, or of a simulation in small strain.
void measurement_stage(Job& job);

/// `model`, fitted to `fit`.
void identification_stage(Job& job);

/// compare.json of the fitted model.
nlohmann::json comparison_stage(Job& job, RunDiagnosis& run_diagnosis);

/// The materials of regions, which stages depend on beside the files of their surfaces.
nlohmann::json moduli_of(const std::vector<mesh::MaterialRegion>& regions);

}  // namespace palpate::pipeline::commands
