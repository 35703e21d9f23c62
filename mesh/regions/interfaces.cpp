#include "mesh/regions/interfaces.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>

#include "mesh/errors.h"
#include "mesh/geometry/with_volume.h"
#include "mesh/meshing/remesh.h"
#include "mesh/regions/check_regions.h"

namespace palpate::mesh {
namespace {

/// Chords of a round region cut volume off; its vertices move out by so much that it is as large as it was.
Surface remeshed(const MaterialRegion& region, double edge) {
    // That is given back. A ball of 80 triangles lacks 13 %: with a quarter of that, elements round it are so small
    // that a body with a bone in it has seven times the nodes.
    constexpr double volume_change = 0.15;
    return with_volume(remesh(region.surface, {.edge_length = edge, .volume_change = volume_change}),
                       std::abs(signed_volume(region.surface)));
}

/// Which of the surfaces meet neither that of the body nor each other.
std::vector<char> clear_ones(const std::vector<Surface>& surfaces, const Surface& body) {
    std::vector<char> is_clear(surfaces.size(), 1);
    for (std::size_t a = 0; a < surfaces.size(); ++a) {
        if (!meeting_places(surfaces[a], body).empty()) is_clear[a] = 0;
        for (std::size_t b = a + 1; b < surfaces.size(); ++b)
            if (!meeting_places(surfaces[a], surfaces[b]).empty()) is_clear[a] = is_clear[b] = 0;
    }
    return is_clear;
}

/// Which elements can follow together, of those that stay clear of the body's surface: from the largest on, each that
/// meets none of them.
std::vector<char> followable(const std::vector<Surface>& surfaces, const Surface& body) {
    std::vector<std::size_t> order(surfaces.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::ranges::stable_sort(order, std::greater{},
                             [&](std::size_t r) { return std::abs(signed_volume(surfaces[r])); });
    std::vector<char> is_followed(surfaces.size(), 0);
    for (const std::size_t r : order) {
        const auto meets = [&](std::size_t other) {
            return is_followed[other] && !meeting_places(surfaces[r], surfaces[other]).empty();
        };
        is_followed[r] = meeting_places(surfaces[r], body).empty() && std::ranges::none_of(order, meets);
    }
    return is_followed;
}

}  // namespace

std::vector<Surface> Interfaces::followed() const {
    std::vector<Surface> result;
    for (std::size_t r = 0; r < surfaces.size(); ++r)
        if (is_followed[r]) result.push_back(surfaces[r]);
    return result;
}

Interfaces remesh_interfaces(const std::vector<MaterialRegion>& regions, const Surface& body, double edge) {
    constexpr double across = 0.6;   // of the side of a cube as large: a ball gets some 80 triangles
    constexpr double shorter = 0.6;  // where surfaces that are close cross, once they are made of longer chords
    constexpr int attempts = 4;
    Interfaces result;
    std::vector<double> edges;
    for (const MaterialRegion& region : regions) {
        result.surfaces.push_back(region.surface);
        edges.push_back(std::min(edge, across * std::cbrt(std::abs(signed_volume(region.surface)))));
    }
    result.is_followed = followable(result.surfaces, body);
    std::vector<char> is_made(regions.size(), 0);
    for (int attempt = 0; attempt < attempts; ++attempt) {
        std::vector<Surface> followed;
        std::vector<std::size_t> place;
        for (std::size_t r = 0; r < regions.size(); ++r) {
            if (!result.is_followed[r]) continue;
            if (!is_made[r]) result.surfaces[r] = remeshed(regions[r], edges[r]);
            is_made[r] = 1;
            followed.push_back(result.surfaces[r]);
            place.push_back(r);
        }
        const std::vector<char> is_clear = clear_ones(followed, body);
        if (std::ranges::count(is_clear, 0) == 0) return result;
        for (std::size_t f = 0; f < place.size(); ++f) {
            if (is_clear[f]) continue;
            edges[place[f]] *= shorter;
            is_made[place[f]] = 0;
        }
    }
    const auto failed = static_cast<std::size_t>(std::ranges::find_if(regions,
                                                                      [&](const MaterialRegion& region) {
                                                                          const auto r = static_cast<std::size_t>(
                                                                              &region - regions.data());
                                                                          return result.is_followed[r] && !is_made[r];
                                                                      }) -
                                                 regions.begin());
    throw SolverFailure(
        fmt::format("the surface of region '{}' comes so close to that of the body, or of another region, that "
                    "triangles of {:.3g} mm cross. Move them apart, or give a smaller edge length.",
                    regions[failed].name, edges[failed] / shorter));
}

}  // namespace palpate::mesh
