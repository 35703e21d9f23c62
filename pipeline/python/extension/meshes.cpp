#include <fmt/format.h>
#include <pybind11/stl/filesystem.h>

#include "mesh/errors.h"
#include "mesh/formats/read_body.h"
#include "mesh/formats/surface/read_surface.h"
#include "mesh/formats/volume/write_volume.h"
#include "mesh/formats/vtk/vtk_files.h"
#include "pipeline/command_line/commands.h"
#include "pipeline/python/extension/bind.h"
#include "pipeline/python/extension/conversions/arrays.h"

namespace palpate::python {
namespace {

namespace fs = std::filesystem;

SharedSurface make_surface(const py::object& vertices, const py::object& triangles) {
    auto surface = std::make_shared<mesh::Surface>();
    surface->vertices = points_of(vertices, "vertices");
    surface->triangles = triangles_of(triangles, "triangles", surface->vertices.rows());
    return surface;
}

SharedMesh make_mesh(const py::object& nodes, const py::object& tetrahedra) {
    auto made = std::make_shared<mesh::VolumeMesh>();
    made->nodes = points_of(nodes, "nodes");
    const auto columns = py::array::ensure(tetrahedra);
    const bool is_table = columns && columns.ndim() == 2 && (columns.shape(1) == 4 || columns.shape(1) == 10);
    const Eigen::MatrixXd corners =
        matrix_of(tetrahedra, "tetrahedra", is_table ? columns.shape(0) : 0, is_table ? columns.shape(1) : 4);
    made->tetrahedra = corners.cast<int>();
    for (Eigen::Index t = 0; t < corners.rows(); ++t) {
        for (const double node : corners.row(t)) {
            if (node >= 0 && node < static_cast<double>(made->nodes.rows()) && node == std::floor(node)) continue;
            throw InvalidInput(fmt::format("tetrahedra: row {} names node {}, there are {}, numbered from 0", t, node,
                                           made->nodes.rows()));
        }
    }
    const Eigen::VectorXd volumes = mesh::element_volumes(*made);
    for (Eigen::Index t = 0; t < volumes.size(); ++t) {
        if (volumes[t] > 0) continue;
        throw InvalidInput(
            fmt::format("tetrahedra: row {} has the volume {:.3g} mm^3, must be above 0; exchange two of its corners",
                        t, volumes[t]));
    }
    made->faces = mesh::boundary_faces(made->tetrahedra);
    return made;
}

void write_mesh(const mesh::VolumeMesh& body, const fs::path& file, bool force) {
    pipeline::commands::refuse_to_overwrite(file, force);
    if (file.extension() == ".vtu") {
        mesh::write_vtu(file, body);
    } else if (file.extension() == ".msh") {
        mesh::write_gmsh(file, body, mesh::GmshVersion::v4_1);
    } else {
        throw InvalidInput(fmt::format("{}: a mesh is written as .vtu or .msh; name the file so", file.string()));
    }
}

SharedMesh read_mesh(const fs::path& file) {
    mesh::BodyFile read = mesh::read_body(file);
    if (!read.volume)
        throw InvalidInput(
            fmt::format("{}: holds a surface and no tetrahedra; palpate.mesh() fills it", file.string()));
    return std::make_shared<mesh::VolumeMesh>(std::move(*read.volume));
}

}  // namespace

void bind_meshes(py::module_& module) {
    py::class_<mesh::Surface, SharedSurface>(module, "Surface", "A triangulated surface [mm].")
        .def(py::init(&make_surface), py::arg("vertices"), py::arg("triangles"),
             "vertices: (n, 3) [mm]; triangles: (m, 3), corners counter-clockwise seen from outside. Both are copied.")
        .def_static(
            "read", [](const fs::path& file) { return std::make_shared<mesh::Surface>(mesh::read_body(file).surface); },
            py::arg("file"), "Reads any file that palpate.run takes as a body; of volume meshes the boundary.")
        .def(
            "write",
            [](const mesh::Surface& s, const fs::path& file, bool force) {
                pipeline::commands::refuse_to_overwrite(file, force);
                mesh::write_surface(file, s);
            },
            py::arg("file"), py::arg("force") = false, "Writes .stl, .obj, .ply, .off or .vtp.")
        .def_property_readonly(
            "vertices", [](const py::object& self) { return view(self.cast<const mesh::Surface&>().vertices, self); },
            "(n, 3) [mm]")
        .def_property_readonly(
            "triangles", [](const py::object& self) { return view(self.cast<const mesh::Surface&>().triangles, self); },
            "(m, 3) rows of vertices")
        .def_property_readonly("volume", &mesh::signed_volume, "enclosed [mm^3], positive where triangles look outward")
        .def_property_readonly("area", &mesh::area, "[mm^2]");

    py::class_<mesh::VolumeMesh, SharedMesh>(module, "Mesh", "A body of tetrahedra [mm].")
        .def(py::init(&make_mesh), py::arg("nodes"), py::arg("tetrahedra"),
             "nodes: (n, 3) [mm]; tetrahedra: (m, 4) or (m, 10) with midsides as VTK numbers them, of positive volume.")
        .def_static("read", &read_mesh, py::arg("file"), "Reads .vtu, .vtk, .msh, .mesh, .node/.ele or .inp.")
        .def("write", &write_mesh, py::arg("file"), py::arg("force") = false, "Writes .vtu or .msh.")
        .def_property_readonly(
            "nodes", [](const py::object& self) { return view(self.cast<const mesh::VolumeMesh&>().nodes, self); },
            "(n, 3) [mm]")
        .def_property_readonly(
            "tetrahedra",
            [](const py::object& self) { return view(self.cast<const mesh::VolumeMesh&>().tetrahedra, self); },
            "(m, 4) or (m, 10) rows of nodes")
        .def_property_readonly(
            "faces", [](const py::object& self) { return view(self.cast<const mesh::VolumeMesh&>().faces, self); },
            "of the boundary, outward: (k, 3) or (k, 6) rows of nodes")
        .def_property_readonly(
            "volume", [](const mesh::VolumeMesh& m) { return mesh::element_volumes(m).sum(); }, "[mm^3]")
        .def_property_readonly(
            "surface",
            [](const mesh::VolumeMesh& m) { return std::make_shared<mesh::Surface>(mesh::boundary_surface(m)); },
            "The boundary, a copy.");
}

}  // namespace palpate::python
