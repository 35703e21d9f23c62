#include "mesh/regions/region_finder.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace palpate::mesh {

RegionFinder::RegionFinder(const std::vector<Surface>& surfaces) {
    std::vector<int> order(surfaces.size());
    std::iota(order.begin(), order.end(), 0);
    const auto volume = [&](int r) { return std::abs(signed_volume(surfaces[static_cast<std::size_t>(r)])); };
    std::ranges::stable_sort(order, [&](int a, int b) { return volume(a) < volume(b); });
    parts_.reserve(surfaces.size());
    for (const int place : order) {
        const Surface& surface = surfaces[static_cast<std::size_t>(place)];
        parts_.push_back({place, bounding_box(surface.vertices), SurfaceTree(surface)});
    }
}

int RegionFinder::operator()(const Vec3& point) const {
    for (const Part& part : parts_) {
        const bool is_in_box =
            (point.array() >= part.box.min.array()).all() && (point.array() <= part.box.max.array()).all();
        if (is_in_box && part.tree.inside(point)) return part.place;
    }
    return -1;
}

}  // namespace palpate::mesh
