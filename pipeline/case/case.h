#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "fem/solver.h"
#include "identify/inference/problem/identify_options.h"
#include "mesh/core/material_region.h"
#include "mesh/core/region.h"
#include "pipeline/case/body_verdict.h"
#include "pipeline/case/probe_options.h"
#include "pipeline/case/run_diagnosis_options.h"
#include "skeleton/construction/build_options.h"

namespace palpate::pipeline {

/// What a sample promises; `run` checks it and ends with exit code 5 where it does not hold.
struct Expectation {
    /// A stiffness that is known, as in posterior.csv.
    struct Parameter {
        std::string name;
        double value;   // in the parameter's unit
        double within;  // as a share of the value
    };
    std::vector<Parameter> parameters;
    std::optional<double> relative_at_most;  // rms error over rms displacement, over all states
    std::optional<double> held_out_at_most;  // the same over states kept from the fit
    std::optional<int> spheres_at_least;
    std::optional<int> modes;                             // of the posterior, none below 5 %
    std::optional<std::string> verdict;                   // of the diagnosis
    std::optional<std::vector<std::string>> explanation;  // the effects that it names, in any order
    std::optional<double> rms_at_most_mm;                 // of the skeleton, once they are in [mm]
};

/// All settings of a run, in mm, N, MPa, s, tonne: what was asked for, and defaults for the rest.
struct Case {
    std::filesystem::path file;  // that it was read from; empty for a bare mesh or set
    std::string name;
    std::optional<std::filesystem::path> mesh;  // one of these two is there
    std::optional<std::filesystem::path> measurements;
    std::optional<std::filesystem::path> model;     // a skeleton to start from, with measurements; else it is made
    double unit = 1;                                // [mm] per unit of the mesh
    double longest = 0;                             // the mesh is scaled to this longest side [mm]; 0: not
    KeptPieces keep = KeptPieces::automatic;        // of a surface of several pieces
    std::optional<int> label;                       // of a label image: which of its labels is the body
    std::vector<mesh::MaterialRegion> regions;      // in the unit of the mesh
    std::vector<mesh::Region> supports;             // empty: the set's, or the default clamp
    std::optional<double> young, poisson, density;  // [MPa], [-], [kg/m^3]; absent: the set's, or defaults
    double edge_length =
        0;  // of the tetrahedra [mm]; 0: 6 % of the longest side, less in a thin body; 7 % where effects are looked for
    bool linear_elements = false;
    fem::Solver solver = fem::Solver::automatic;  // of the body that is probed
    skeleton::BuildOptions skeleton;
    bool sphere_curve = false;  // measure what more and fewer spheres would do
    ProbeOptions probing{.probes = 60, .held_out = 12};
    std::optional<std::filesystem::path> prior;  // population.json, of which `identify.priors` are
    identify::IdentifyOptions identify;
    RunDiagnosisOptions diagnose;
    Expectation expect;
};

}  // namespace palpate::pipeline
