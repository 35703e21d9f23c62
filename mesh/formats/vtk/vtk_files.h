#pragma once

#include <filesystem>
#include <string>
#include <variant>
#include <vector>

#include "mesh/core/surface.h"
#include "mesh/core/volume_mesh.h"

namespace palpate::mesh {

/// A named array for ParaView, a row per point or cell; the name carries the unit, as in "error [mm]".
struct DataArray {
    std::string name;
    Eigen::MatrixXd values;  // (n x components)
};

struct MeshData {
    std::vector<DataArray> points = {};  // a row per point
    std::vector<DataArray> cells = {};   // a row per cell
};

void write_vtu(const std::filesystem::path& file, const VolumeMesh& mesh, const MeshData& data = {});
void write_vtp(const std::filesystem::path& file, const Surface& surface, const MeshData& data = {});

/// Points as vertices, and lines between them (l x 2); either may be empty.
void write_vtp_lines(const std::filesystem::path& file, const Points& points,
                     const Eigen::Matrix<int, Eigen::Dynamic, 2>& lines, const MeshData& data = {});

/// A step of a series: the file is told relative to the .pvd.
struct SeriesStep {
    double time;
    std::filesystem::path file;
};
void write_pvd(const std::filesystem::path& file, const std::vector<SeriesStep>& steps);

/// The mesh of a VTU file; `data` (when asked for) its arrays.
/// @throws IoError, InvalidInput when the file holds no tetrahedra or several kinds of cell.
VolumeMesh read_vtu(const std::filesystem::path& file, MeshData* data = nullptr);

}  // namespace palpate::mesh
