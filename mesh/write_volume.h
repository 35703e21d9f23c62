#pragma once

#include <filesystem>
#include <vector>

#include "mesh/volume_mesh.h"

namespace palpate::mesh {

/// What an input file of a solver says besides the mesh.
struct SolverSetting {
    std::vector<char> held;                      // a flag a node (n)
    double young = 0, poisson = 0, density = 0;  // [MPa], [-], [tonne/mm^3]
};

/// An input file for Abaqus and CalculiX: nodes, elements C3D4 or C3D10 (their midsides are numbered as VTK's), the
/// node sets NALL, NSKIN and NHELD, the element set EBODY, the surface SKIN of element sides, material and section. A
/// step is left to the user. @throws IoError.
void write_inp(const std::filesystem::path& file, const VolumeMesh& mesh, const SolverSetting& setting);

enum class GmshVersion { v2_2, v4_1 };

/// A text file for Gmsh: the tetrahedra as physical volume 1 "body", its boundary as physical surface 2 "skin".
/// @throws IoError.
void write_gmsh(const std::filesystem::path& file, const VolumeMesh& mesh, GmshVersion version);

}  // namespace palpate::mesh
