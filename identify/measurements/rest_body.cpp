#include "identify/measurements/rest_body.h"

#include <fmt/format.h>

namespace palpate::identify {

// The area vectors of a closed surface cancel.
RestBody::RestBody(const mesh::Surface& surface)
    : tree(surface),
      box(mesh::bounding_box(surface.vertices)),
      is_closed(mesh::area_vectors(surface).colwise().sum().norm() < 1e-6 * mesh::area(surface)) {}

bool RestBody::holds(const Vec3& point) const {
    if (is_closed) return tree.inside(point);
    return (point.array() >= box.min.array()).all() && (point.array() <= box.max.array()).all();
}

double RestBody::depth(const Vec3& point) const {
    return is_closed && tree.inside(point) ? tree.closest(point).distance : 0;
}

std::string place_in_words(const Vec3& place) { return fmt::format("[{:.4g}] mm", fmt::join(place, ", ")); }

}  // namespace palpate::identify
