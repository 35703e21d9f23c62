#include <CGAL/Polygon_mesh_processing/orient_polygon_soup.h>
#include <CGAL/Polygon_mesh_processing/repair_polygon_soup.h>
#include <CGAL/Polygon_mesh_processing/stitch_borders.h>

#include "mesh/meshing/repair/steps.h"
#include "mesh/topology/cgal_mesh.h"

namespace palpate::mesh {

namespace pmp = CGAL::Polygon_mesh_processing;

Surface orient_and_stitch(const Surface& surface) {
    // Triangles with a repeated corner, twins and loose points go first.
    cgal::Soup soup = cgal::to_soup(surface);
    std::erase_if(soup.triangles, [](const auto& t) { return t[0] == t[1] || t[1] == t[2] || t[2] == t[0]; });
    pmp::merge_duplicate_polygons_in_polygon_soup(soup.points, soup.triangles);
    pmp::remove_isolated_points_in_polygon_soup(soup.points, soup.triangles);

    pmp::orient_polygon_soup(soup.points, soup.triangles);
    cgal::Mesh mesh = cgal::to_mesh(soup);
    pmp::stitch_borders(mesh);
    return cgal::from_mesh(mesh);
}

}  // namespace palpate::mesh
