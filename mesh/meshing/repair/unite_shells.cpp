#include <CGAL/Polygon_mesh_processing/corefinement.h>

#include "mesh/errors.h"
#include "mesh/meshing/repair/steps.h"
#include "mesh/topology/cgal_mesh.h"
#include "mesh/topology/shells.h"

namespace palpate::mesh {

namespace pmp = CGAL::Polygon_mesh_processing;

Surface unite_shells(const Surface& surface) {
    cgal::Mesh whole;
    try {
        for (Surface shell : split_parts(surface)) {
            if (signed_volume(shell) < 0) shell.triangles.col(1).swap(shell.triangles.col(2));
            cgal::Mesh part = cgal::to_mesh(cgal::to_soup(shell)), both;
            if (!CGAL::is_closed(part)) throw SolverFailure("A shell is not closed.");
            if (!pmp::corefine_and_compute_union(whole, part, both, CGAL::parameters::throw_on_self_intersection(true)))
                throw SolverFailure("Two shells have no union that is a surface.");
            whole = both;
        }
    } catch (const pmp::Corefinement::Self_intersection_exception&) {
        throw SolverFailure("A shell crosses itself.");
    }
    return cgal::from_mesh(whole);
}

}  // namespace palpate::mesh
