#pragma once

#include <filesystem>
#include <vector>

#include "mesh/core/volume_mesh.h"

namespace palpate::mesh {

/// A material of a solver's input file.
struct SolverMaterial {
    double young = 0, poisson = 0, density = 0;  // [MPa], [-], [tonne/mm^3]
};

/// What an input file of a solver says besides the mesh.
struct SolverSetting {
    std::vector<char> held;  // a flag a node (n)
    SolverMaterial material;
    std::vector<SolverMaterial> regions = {};  // parts of materials of their own
    std::vector<int> region_of_element = {};   // -1: of none; empty: all are
    bool is_neo_hookean = false;               // else linear; both are compressible
    bool large_deformation = false;            // of the steps
    std::vector<Eigen::VectorXd> steps = {};   // nodal forces of each (3n) [N]
};

/// An input file for Abaqus and CalculiX: nodes, elements C3D4 or C3D10 (their midsides are numbered as VTK's), the
/// node sets NALL, NSKIN and NHELD, the element set EBODY (with regions EBODY0, of none, and EREGION1, ...), the
/// surface SKIN of element sides, material, section and
/// static steps, which write displacements at their ends. Without any, steps and supports are left to the user.
/// Neo-Hookean: W = C10 (J^-2/3 tr F^T F - 3) + (J - 1)^2 / D1, C10 = mu / 2, D1 = 2 / K. @throws IoError.
void write_inp(const std::filesystem::path& file, const VolumeMesh& mesh, const SolverSetting& setting);

enum class GmshVersion { v2_2, v4_1 };

/// A text file for Gmsh: the tetrahedra as physical volume 1 "body", its boundary as physical surface 2 "skin".
/// @throws IoError.
void write_gmsh(const std::filesystem::path& file, const VolumeMesh& mesh, GmshVersion version);

}  // namespace palpate::mesh
