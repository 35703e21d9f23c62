#include "mesh/formats/cad/tessellate.h"

#include <BRepAlgoAPI_Fuse.hxx>
#include <BRepBndLib.hxx>
#include <BRepBuilderAPI_Sewing.hxx>
#include <BRepMesh_IncrementalMesh.hxx>
#include <BRep_Tool.hxx>
#include <Bnd_Box.hxx>
#include <IGESControl_Reader.hxx>
#include <Poly_Triangulation.hxx>
#include <STEPControl_Reader.hxx>
#include <Standard_Failure.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopTools_ListOfShape.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Face.hxx>
#include <TopoDS_Shape.hxx>

#include <array>
#include <cctype>
#include <cmath>
#include <vector>

namespace palpate::mesh {
namespace {

constexpr double angle = 0.3;        // between neighbouring triangles of one face [rad]
constexpr double sewing_gap = 1e-4;  // that is closed between faces, as a share of the diagonal

/// Millimetres: OpenCASCADE converts to them by what the file says.
TopoDS_Shape read_shape(const std::filesystem::path& file) {
    const auto read = [&](auto&& reader) -> TopoDS_Shape {
        if (reader.ReadFile(file.c_str()) != IFSelect_RetDone) return {};
        reader.TransferRoots();
        return reader.OneShape();
    };
    const bool is_iges = std::tolower(static_cast<unsigned char>(file.extension().string()[1])) == 'i';
    return is_iges ? read(IGESControl_Reader()) : read(STEPControl_Reader());
}

std::vector<TopoDS_Shape> parts_of(const TopoDS_Shape& shape, TopAbs_ShapeEnum kind) {
    TopTools_IndexedMapOfShape found;
    TopExp::MapShapes(shape, kind, found);
    std::vector<TopoDS_Shape> parts;
    for (int i = 1; i <= found.Extent(); ++i) parts.push_back(found(i));
    return parts;
}

double diagonal(const TopoDS_Shape& shape) {
    Bnd_Box box;
    BRepBndLib::Add(shape, box);
    return box.IsVoid() ? 0 : std::sqrt(box.SquareExtent());
}

/// The solids as one where they touch; nothing where that has no answer.
TopoDS_Shape united(const std::vector<TopoDS_Shape>& solids) {
    TopTools_ListOfShape first, others;
    first.Append(solids[0]);
    for (std::size_t i = 1; i < solids.size(); ++i) others.Append(solids[i]);
    BRepAlgoAPI_Fuse fuse;
    fuse.SetArguments(first);
    fuse.SetTools(others);
    fuse.Build();
    return fuse.HasErrors() ? TopoDS_Shape() : fuse.Shape();
}

TopoDS_Shape sewn(const TopoDS_Shape& shape, double gap) {
    BRepBuilderAPI_Sewing sewing(gap);
    sewing.Add(shape);
    sewing.Perform();
    return sewing.SewedShape();
}

/// The triangles of one face, turned as the face is; false where it has none.
bool add_face(const TopoDS_Face& face, std::vector<Vec3>& vertices, std::vector<std::array<int, 3>>& triangles) {
    TopLoc_Location place;
    const Handle(Poly_Triangulation) mesh = BRep_Tool::Triangulation(face, place);
    if (mesh.IsNull() || mesh->NbTriangles() == 0) return false;
    const auto first = static_cast<int>(vertices.size());
    for (int v = 1; v <= mesh->NbNodes(); ++v) {
        const gp_Pnt at = mesh->Node(v).Transformed(place.Transformation());
        vertices.emplace_back(at.X(), at.Y(), at.Z());
    }
    const bool is_mirrored = place.Transformation().IsNegative();
    const bool is_turned = (face.Orientation() == TopAbs_REVERSED) != is_mirrored;
    for (int t = 1; t <= mesh->NbTriangles(); ++t) {
        std::array<int, 3> corners{};
        mesh->Triangle(t).Get(corners[0], corners[1], corners[2]);
        if (is_turned) std::swap(corners[1], corners[2]);
        for (int& corner : corners) corner += first - 1;
        triangles.push_back(corners);
    }
    return true;
}

void add_triangles(const TopoDS_Shape& shape, Tessellation& result) {
    std::vector<Vec3> vertices;
    std::vector<std::array<int, 3>> triangles;
    for (TopExp_Explorer face(shape, TopAbs_FACE); face.More(); face.Next()) {
        ++result.faces;
        if (!add_face(TopoDS::Face(face.Current()), vertices, triangles)) ++result.faces_missing;
    }
    result.surface = {Points(static_cast<Eigen::Index>(vertices.size()), 3),
                      Triangles(static_cast<Eigen::Index>(triangles.size()), 3)};
    for (std::size_t v = 0; v < vertices.size(); ++v)
        result.surface.vertices.row(static_cast<Eigen::Index>(v)) = vertices[v];
    for (std::size_t t = 0; t < triangles.size(); ++t)
        for (int c = 0; c < 3; ++c)
            result.surface.triangles(static_cast<Eigen::Index>(t), c) = triangles[t][static_cast<std::size_t>(c)];
}

}  // namespace

Tessellation tessellate(const std::filesystem::path& file, bool unite, double chord_share) {
    Tessellation result;
    try {
        TopoDS_Shape shape = read_shape(file);
        if (shape.IsNull() || parts_of(shape, TopAbs_FACE).empty()) {
            result.error = "OpenCASCADE finds no faces in it";
            return result;
        }
        const std::vector<TopoDS_Shape> solids = parts_of(shape, TopAbs_SOLID);
        result.solids = result.solids_united = static_cast<int>(solids.size());
        if (solids.empty()) {
            shape = sewn(shape, sewing_gap * diagonal(shape));
        } else if (solids.size() > 1 && unite) {
            const TopoDS_Shape one = united(solids);
            if (one.IsNull()) {
                result.error = "OpenCASCADE finds no union of its solids";
                return result;
            }
            shape = one;
            result.solids_united = static_cast<int>(parts_of(shape, TopAbs_SOLID).size());
        }
        result.chord = chord_share * diagonal(shape);
        BRepMesh_IncrementalMesh(shape, result.chord, false, angle, false);
        add_triangles(shape, result);
    } catch (const Standard_Failure& failure) {
        result.error = std::string("OpenCASCADE gives up: ") + failure.GetMessageString();
    }
    return result;
}

}  // namespace palpate::mesh
