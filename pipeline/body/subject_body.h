#pragma once

#include "mesh/progress.h"
#include "pipeline/body/body.h"
#include "pipeline/case/subject.h"

namespace palpate::pipeline {

/// The body of a subject, ready-made where it has a mesh. @throws InvalidInput, SolverFailure.
MeshedBody make_body(const Subject& subject, const MeshingOptions& options, const Progress& progress = {});

}  // namespace palpate::pipeline
