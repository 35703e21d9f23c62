#pragma once

#include <filesystem>
#include <string>

#include "mesh/core/surface.h"

namespace palpate::mesh {

/// What OpenCASCADE made of a file.
struct Tessellation {
    std::string error;      // in words; empty: none
    int solids = 0;         // in the file
    int solids_united = 0;  // after uniting those that touch; as many as in the file where that was not asked
    int faces = 0, faces_missing = 0;  // of them without triangles
    double chord = 0;                  // [mm]
    Surface surface;
};

/// Reads STEP or IGES by extension and meshes its faces; `unite` joins several solids to one. May crash or never end on
/// a broken file: call it in a child process.
Tessellation tessellate(const std::filesystem::path& file, bool unite, double chord_share);

}  // namespace palpate::mesh
