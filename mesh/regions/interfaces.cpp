#include "mesh/regions/interfaces.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "mesh/errors.h"
#include "mesh/meshing/remesh.h"
#include "mesh/regions/check_regions.h"

namespace palpate::mesh {
namespace {

/// Chords of a round region cut volume off; its vertices move out by so much that it is as large as it was.
Surface with_volume(Surface surface, double volume) {
    const double lacking = std::abs(volume) - signed_volume(surface);
    surface.vertices += lacking / area(surface) * vertex_normals(surface);
    return surface;
}

Surface remeshed(const MaterialRegion& region, double edge) {
    constexpr double volume_change = 0.03;  // that is given back
    return with_volume(remesh(region.surface, {.edge_length = edge, .volume_change = volume_change}),
                       signed_volume(region.surface));
}

}  // namespace

std::vector<Surface> remesh_interfaces(const std::vector<MaterialRegion>& regions, const Surface& body, double edge) {
    constexpr double across = 0.6;   // of the side of a cube as large: a ball gets some 80 triangles
    constexpr double shorter = 0.6;  // where surfaces that are close cross, once they are made of longer chords
    constexpr int attempts = 4;
    std::vector<double> edges;
    for (const MaterialRegion& region : regions)
        edges.push_back(std::min(edge, across * std::cbrt(std::abs(signed_volume(region.surface)))));
    std::vector<Surface> result(regions.size());
    std::vector<char> is_made(regions.size(), 0);
    for (int attempt = 0; attempt < attempts; ++attempt) {
        for (std::size_t r = 0; r < regions.size(); ++r) {
            if (!is_made[r]) result[r] = remeshed(regions[r], edges[r]);
            is_made[r] = 1;
        }
        const auto redo = [&](std::size_t r) {
            if (is_made[r]) edges[r] *= shorter;
            is_made[r] = 0;
        };
        for (std::size_t a = 0; a < regions.size(); ++a) {
            if (!meeting_places(result[a], body).empty()) redo(a);
            for (std::size_t b = a + 1; b < regions.size(); ++b) {
                if (meeting_places(result[a], result[b]).empty()) continue;
                redo(a);
                redo(b);
            }
        }
        if (std::ranges::count(is_made, 0) == 0) return result;
    }
    const auto failed = static_cast<std::size_t>(std::ranges::find(is_made, 0) - is_made.begin());
    throw SolverFailure(
        fmt::format("the surface of region '{}' comes so close to that of the body, or of another region, that "
                    "triangles of {:.3g} mm cross. Move them apart, or give a smaller edge length.",
                    regions[failed].name, edges[failed] / shorter));
}

}  // namespace palpate::mesh
