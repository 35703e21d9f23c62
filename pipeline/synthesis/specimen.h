#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "fem/material.h"
#include "identify/measurements/measurement_set.h"
#include "identify/models/body_model.h"
#include "mesh/core/volume_mesh.h"
#include "mesh/progress.h"
#include "pipeline/case/probe_options.h"
#include "pipeline/case/subject/subject.h"
#include "pipeline/synthesis/loading/probe_load_history.h"
#include "pipeline/synthesis/options.h"
#include "skeleton/model/model.h"

namespace palpate::pipeline {

/// What is probed, a body in finite elements or a skeleton, with all that is known of it. It is the truth behind the
/// readings.
struct Specimen {
    std::unique_ptr<const identify::BodyModel> model;
    identify::ModelSetting setting;             // its law and stiffness, and the effects that it has anyway
    identify::MeasurementSet set;               // all of the set but its states
    std::vector<mesh::Contact> contacts;        // where it is touched, one a probe, with forces of 1 N
    std::vector<ProbeLoadHistory> driven = {};  // probes of a rig, in place of those contacts
    double most_force = 0;                      // that any of them may bear [N]
    double stiffness = 0;                       // about its Young's modulus [MPa]
    std::optional<fem::Material> material;      // of finite elements
    mesh::VolumeMesh volume;                    // of finite elements
    std::vector<std::string> notes;             // what a user should know, in words

    bool is_skeleton() const { return !material; }
    bool in_small_strain() const { return !model->is_nonlinear(setting); }
    const std::string& law() const { return model->laws()[static_cast<std::size_t>(setting.law)]; }
};

/// The subject's body in quadratic tetrahedra, finer than those that `run` fits with, curved to the surface as they
/// are: the error of one mesh is not that of the other. @throws InvalidInput, SolverFailure as make_body.
Specimen finite_element_specimen(const Subject& subject, const BlindSetOptions& options, const Progress& progress);

/// The skeleton itself, with its stiffness, law and effects. One whose spheres stand on its skin is touched at its
/// spheres, four markers on each tell how they stand and turn [Burion 2008, section IV]; others are touched and read on
/// their skin, as a body is. @throws InvalidInput when none of its spheres is free, or
/// it has no such law.
Specimen skeleton_specimen(const skeleton::Model& model, const ProbeOptions& probing, const BlindSetOptions& options,
                           std::uint64_t seed);

}  // namespace palpate::pipeline
