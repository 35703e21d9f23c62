#pragma once

#include <string>
#include <vector>

#include "fem/large_deformation/material_law.h"
#include "identify/measurements/measurement_set.h"
#include "mesh/progress.h"
#include "pipeline/case/subject/subject.h"

namespace palpate::pipeline {

/// How a body is probed to see how well skeletons follow it.
struct QualityProbing {
    fem::MaterialLaw law =
        fem::MaterialLaw::linear;  // linear: largest displacements of 0.5 % of the longest side; others: 5 %
    int fit = 48;                  // probes that skeletons are fitted to, [1, 1000]
    int held_out = 48;             // other ones that they are judged by, [1, 1000]
    int threads = 1;               // changes no number
    void validate() const;         // @throws InvalidInput naming option, value and bound
};

/// What the body in finite elements does under probes: 150 points of its surface are fitted to, all that no support
/// holds are judged by.
struct ProbedQuality {
    identify::MeasurementSet fit, held_out;
    int nodes = 0;                   // of the finite elements
    std::vector<std::string> notes;  // what a user should know, in words
};

/// Probes the subject's body in quadratic tetrahedra, meshed finer than what skeletons are made of. Contacts are spread
/// over the free surface, push, pull and sideways in turn; those held out are drawn from among them.
/// @throws InvalidInput, SolverFailure as synthesise.
ProbedQuality probe_for_quality(const Subject& subject, const QualityProbing& options, const Progress& progress = {});

}  // namespace palpate::pipeline
