#pragma once

#include <optional>
#include <string>
#include <vector>

#include "fem/material.h"
#include "identify/measurements/measurement_set.h"
#include "mesh/core/region.h"
#include "mesh/core/surface.h"
#include "mesh/core/volume_mesh.h"
#include "pipeline/case/case.h"

namespace palpate::pipeline {

/// What a case is about, read and converted: a body's surface [mm], where it is held, what it is made of, and the
/// measurements if there are any.
struct Subject {
    Case settings;
    mesh::Surface surface;
    std::optional<mesh::VolumeMesh> volume;  // a ready-made mesh of the body, behind that surface
    std::vector<mesh::Region> supports;
    fem::Material material;
    std::vector<mesh::MaterialRegion> regions;  // of materials of their own [mm]
    std::optional<identify::MeasurementSet> set;
    std::vector<std::filesystem::path> files;  // that were read
    std::vector<std::string> notes;            // what was found and done in reading it, in words
    std::vector<std::string> assumptions;      // what was not specified and is assumed, in words
    std::string refusal;                       // why its surface is of no body, in words; empty: it may be one
};

/// A measurement set with readings: where it has full fields only, vertices of its surface are read from them; those
/// without a marker's name are given one, or left out; supports and grips that are given by points are the patches that
/// these sample; displacements since an unloaded state are positions from rest. `notes` says so, and what hints at a
/// slip of units.
/// @param edge_length of the elements that are to be held [mm]; 0: those of a reference body
/// @throws IoError, InvalidInput.
identify::MeasurementSet read_measurements(const std::filesystem::path& path, std::vector<std::string>& notes,
                                           double edge_length = 0);

/// @throws IoError, InvalidInput, also where its surface is of no body.
Subject read_subject(Case settings);
/// The same, where it is not refused yet: for those who tell what is wrong. @throws IoError, InvalidInput.
Subject read_subject_as_it_is(Case settings);

}  // namespace palpate::pipeline
