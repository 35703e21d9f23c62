#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "fem/material.h"
#include "identify/identify.h"
#include "identify/measurements/measurement_set.h"
#include "mesh/core/region.h"
#include "skeleton/construction/build.h"

namespace palpate::pipeline {

/// How a reference simulation probes a body.
struct ProbeOptions {
    static constexpr int most_probes = 10000, least_markers = 3, most_markers = 100000;
    static constexpr double most_share = 0.5;  // of the longest side

    int probes = 12;          // places that are touched, [1, most_probes]
    int held_out = 0;         // of them, how many are kept from the fit, spread evenly
    int markers = 150;        // surface points that are read, [least_markers, most_markers]
    double displacement = 0;  // largest, as a share of the longest side, [0, most_share]; 0: by how far the law reaches
    double radius = 0.06;     // of a contact patch, as a share of the longest side, (0, most_share]
    double noise = 0;         // 1 sigma added to every reading [mm]
    void validate() const;
    /// What is asked for, else 0.5 % in small strain and 5 % in large deformation.
    double largest_displacement(bool small_strain) const {
        return displacement > 0 ? displacement : small_strain ? 0.005 : 0.05;
    }
};

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

/// Diagnosis options of a run.
struct RunDiagnosisOptions {
    bool reference = true;             // on the body in finite elements; false: it is not asked
    std::vector<std::string> without;  // effects left out of the catalogue
    void validate() const;
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
    std::optional<int> label;                       // of a label image: which of its labels is the body
    std::vector<mesh::Region> supports;             // empty: the set's, or the default clamp
    std::optional<double> young, poisson, density;  // [MPa], [-], [kg/m^3]; absent: the set's, or defaults
    double edge_length =
        0;  // of the tetrahedra [mm]; 0: 6 % of the longest side, less in a thin body; 7 % where effects are looked for
    bool linear_elements = false;
    skeleton::BuildOptions skeleton;
    bool sphere_curve = false;  // measure what more and fewer spheres would do
    ProbeOptions probing{.probes = 60, .held_out = 12};
    identify::IdentifyOptions identify;
    RunDiagnosisOptions diagnose;
    Expectation expect;
};

class CaseOverrides;

/// A case from a case.yaml, a measurement set (folder or set.yaml) or a bare mesh, told apart by what they are.
/// @throws IoError, InvalidInput.
Case read_case(const std::filesystem::path& input, const CaseOverrides& overrides);
Case read_case(const std::filesystem::path& input);

/// The case with every setting, defaults included, as YAML that read_case reads back.
std::string to_yaml(const Case& settings);

}  // namespace palpate::pipeline
