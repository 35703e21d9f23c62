#include <CGAL/Polygon_mesh_processing/repair_degeneracies.h>
#include <CGAL/Polygon_mesh_processing/repair_self_intersections.h>

#include "mesh/meshing/repair/steps.h"
#include "mesh/topology/cgal_mesh.h"

namespace palpate::mesh {

namespace pmp = CGAL::Polygon_mesh_processing;

Surface remove_crossings(const Surface& surface) {
    const cgal::Soup soup = cgal::to_soup(surface);
    if (!cgal::is_mesh(soup)) return surface;
    cgal::Mesh mesh = cgal::to_mesh(soup);
    pmp::remove_degenerate_faces(mesh);
    pmp::experimental::remove_self_intersections(mesh, CGAL::parameters::preserve_genus(false));
    return cgal::from_mesh(mesh);
}

}  // namespace palpate::mesh
