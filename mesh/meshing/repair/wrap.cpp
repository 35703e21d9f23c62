#include <CGAL/alpha_wrap_3.h>

#include "mesh/meshing/repair/steps.h"
#include "mesh/topology/cgal_mesh.h"

namespace palpate::mesh {

Surface wrap(const Surface& surface, double alpha, double offset) {
    const cgal::Soup soup = cgal::to_soup(surface);
    cgal::Mesh mesh;
    CGAL::alpha_wrap_3(soup.points, soup.triangles, alpha, offset, mesh);
    return cgal::from_mesh(mesh);
}

}  // namespace palpate::mesh
