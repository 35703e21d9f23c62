#include "skeleton/links/rest_direction.h"

#include <fmt/format.h>

#include "mesh/errors.h"

namespace palpate::skeleton {

Vec3 rest_direction(const Model& model, const Link& link) {
    const Vec3 dx = model.spheres[link.b].center - model.spheres[link.a].center;
    const double distance = dx.norm();
    if (!(distance > 0))
        throw InvalidInput(
            fmt::format("spheres {} and {} are linked but have the same centre ({}, {}, {}): "
                        "move one of them or take the link away",
                        link.a, link.b, model.spheres[link.a].center.x(), model.spheres[link.a].center.y(),
                        model.spheres[link.a].center.z()));
    return dx / distance;
}

}  // namespace palpate::skeleton
