#pragma once

#include <string>
#include <vector>

#include "pipeline/analysis/quality/errors.h"
#include "pipeline/analysis/quality/graph.h"
#include "pipeline/analysis/quality/shape.h"
#include "pipeline/body/body.h"
#include "pipeline/case/subject/subject.h"

namespace palpate::pipeline {

struct QualityOptions {
    std::vector<int> spheres{8, 16, 32, 64, 128, 256, 512};  // free ones of each step, [1, 20000]
    int fit = 48;                                            // probes that skeletons are fitted to, [1, 1000]
    int held_out = 48;                                       // other ones that they are judged by, [1, 1000]
    int threads = 1;                                         // changes no number
    void validate() const;                                   // @throws InvalidInput naming option, value and bound
};

/// A skeleton of so many spheres, measured.
struct QualityStep {
    bool is_own = false;        // the one that was asked for, not one of the ladder
    int spheres = 0, held = 0;  // free ones; those in supports
    int links = 0;
    int fit = 0;  // probes that it was fitted to
    ShapeQuality shape;
    GraphQuality graph;
    ErrorSummary error;  // after the fit, held-out probes, by the linear law
    double seconds_build = 0, seconds_fit = 0;
};

struct Quality {
    int nodes = 0;                   // of the finite elements that skeletons are judged by
    std::vector<QualityStep> steps;  // by rising number of spheres
    std::vector<std::string> notes;  // what a user should know, in words
};

/// Measures `model` and skeletons of more and fewer spheres of the same body: how they fill it, and how far they are,
/// fitted link by link, from finite elements in small strain (displacements of 0.5 % of the longest side). The ladder
/// ends where the body has no room for more spheres. Big skeletons are fitted to half as many probes.
/// @throws InvalidInput, SolverFailure as probe_for_quality and identify.
Quality measure_quality(const Subject& subject, const MeshedBody& body, const skeleton::Model& model,
                        const QualityOptions& options, const Progress& progress = {});

}  // namespace palpate::pipeline
