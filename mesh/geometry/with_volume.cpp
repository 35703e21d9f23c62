#include "mesh/geometry/with_volume.h"

namespace palpate::mesh {

Surface with_volume(Surface surface, double volume) {
    for (int step = 0; step < 3; ++step) {
        const double shift = (volume - signed_volume(surface)) / area(surface);
        surface.vertices += shift * vertex_normals(surface);
    }
    return surface;
}

}  // namespace palpate::mesh
