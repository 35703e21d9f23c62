#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "mesh/core/surface.h"
#include "mesh/core/volume_mesh.h"

namespace palpate::mesh {

struct ReadBodyOptions {
    std::optional<int> label;  // of a label image: which of its labels is the body; absent: there is but one
    /// Labels of parts whose surfaces are asked for: of elements by their cell array of materials, or of voxels. An
    /// image's body is all that has a label, then.
    std::vector<int> parts = {};
};

/// A body as a file tells it.
struct BodyFile {
    Surface surface;                           // of volume meshes their boundary
    std::optional<VolumeMesh> volume;          // of volume meshes
    std::vector<Surface> parts = {};           // closed and outward, in the order in which they were asked for
    bool is_in_mm = false;                     // the file tells its unit, and it has been converted
    std::vector<std::string> notes;            // what was found and done on the way, in words
    std::vector<std::filesystem::path> files;  // that were read
};

/// Reads a body from a surface file (or legacy .vtk), a mesh of tetrahedra (VTU, .vtk, Gmsh .msh, MEDIT .mesh, TetGen
/// .node and .ele, Abaqus and CalculiX .inp), CAD (STEP, IGES) or an image of labels (NIfTI, NRRD, MetaImage), told
/// apart by extension. Surfaces are not repaired here. Parts are refused where the file tells no labels, or not that
/// one.
/// @throws IoError, InvalidInput naming file and line or element, the value, what is allowed, what to do.
BodyFile read_body(const std::filesystem::path& file, const ReadBodyOptions& options = {});

/// Does the extension name one of these kinds?
bool is_body_file(const std::filesystem::path& file);

/// The name without the extension, which may be double as in "liver.nii.gz".
std::string body_name(const std::filesystem::path& file);

/// The extensions, for a message.
std::string body_extensions();

}  // namespace palpate::mesh
