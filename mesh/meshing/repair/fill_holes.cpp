#include <CGAL/Polygon_mesh_processing/border.h>
#include <CGAL/Polygon_mesh_processing/triangulate_hole.h>

#include <iterator>

#include "mesh/meshing/repair/steps.h"
#include "mesh/topology/cgal_mesh.h"

namespace palpate::mesh {

namespace pmp = CGAL::Polygon_mesh_processing;

Surface fill_holes(const Surface& surface, double largest) {
    const cgal::Soup soup = cgal::to_soup(surface);
    if (!cgal::is_mesh(soup)) return surface;
    cgal::Mesh mesh = cgal::to_mesh(soup);
    std::vector<cgal::Mesh::Halfedge_index> borders;
    pmp::extract_boundary_cycles(mesh, std::back_inserter(borders));
    for (const auto border : borders) {
        CGAL::Bbox_3 box;
        for (const auto h : CGAL::halfedges_around_face(border, mesh)) box += mesh.point(mesh.target(h)).bbox();
        const Vec3 extent(box.x_span(), box.y_span(), box.z_span());
        if (extent.norm() > largest) continue;
        std::vector<cgal::Mesh::Face_index> patch;
        pmp::triangulate_hole(mesh, border, std::back_inserter(patch));
    }
    return cgal::from_mesh(mesh);
}

}  // namespace palpate::mesh
