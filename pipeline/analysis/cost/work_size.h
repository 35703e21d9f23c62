#pragma once

#include "fem/solver_forecast.h"
#include "mesh/progress.h"
#include "pipeline/case/subject/subject.h"

namespace palpate::pipeline {

/// How much a run has to do.
struct WorkSize {
    double nodes = 0, tetrahedra = 0, skin = 0;         // of the body; corners of its surface
    double sample_tetrahedra = 0, seconds_to_mesh = 0;  // of what was meshed to count them, repair included
    double skeleton_nodes = 0;                          // that the skeleton's skin is found with: fewer in a large body
    double spheres = 0, links = 0, parameters = 0;
    double states = 0, fitted = 0, markers = 0;  // of the measurements; states that the skeleton is fitted to
    double reference_nodes = 0, loaded = 0;      // of the body that is diagnosed, and its loaded states; 0: none is
    bool is_simulated = false;                   // there are no measurements: a body is probed
    fem::SolverForecast probed = {}, condensed = {};  // how the body's equations are solved: probed, for the skeleton
};

/// Counts what a run of a subject would do. A body of more than some 20,000 nodes is meshed more coarsely: nodes within
/// grow as edge^-3, those of its surface as edge^-2. Its skeleton is built, of 300 spheres at most.
/// @throws InvalidInput, SolverFailure where the run would, too.
WorkSize size_of_run(const Subject& subject, const Progress& progress);

}  // namespace palpate::pipeline
