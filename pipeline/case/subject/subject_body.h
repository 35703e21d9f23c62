#pragma once

#include <vector>

#include "fem/material.h"
#include "mesh/formats/vtk/vtk_files.h"
#include "mesh/progress.h"
#include "pipeline/body/body.h"
#include "pipeline/case/subject/subject.h"

namespace palpate::pipeline {

/// The body of a subject and its regions, ready-made where it has a mesh. @throws InvalidInput, SolverFailure.
MeshedBody make_body(const Subject& subject, MeshingOptions options, const Progress& progress = {});

/// The region of each element, by place among the subject's; -1: of none; empty: there are no regions.
std::vector<int> element_regions(const Subject& subject, const MeshedBody& body);
/// What the elements of a subject are made of; regions of unknown stiffness are as stiff as the rest.
fem::Materials materials_of(const Subject& subject, std::vector<int> element_regions);

/// Element regions as an array of cells, their numbers from 1 on, 0: of none; nothing where there are no regions.
mesh::MeshData regions_shown(const std::vector<int>& element_regions);
/// The same back.
std::vector<int> regions_read(const mesh::MeshData& data);

}  // namespace palpate::pipeline
