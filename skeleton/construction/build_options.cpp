#include "skeleton/construction/build_options.h"

#include <fmt/format.h>

#include <cmath>

#include "mesh/errors.h"

namespace palpate::skeleton {

void BuildOptions::validate() const {
    if (spheres < 0 || spheres > most_spheres) {
        throw InvalidInput(fmt::format("spheres is {}: allowed are 1 to {}, or 0 to let the body's shape decide",
                                       spheres, most_spheres));
    }
    if (!(coverage >= 0) || !std::isfinite(coverage)) {
        throw InvalidInput(fmt::format(
            "coverage is {} mm: allowed are positive lengths, or 0 for 5 % of the body's longest side", coverage));
    }
    if (zones < 1 || zones > most_zones)
        throw InvalidInput(fmt::format("zones is {}: allowed are 1 to {}", zones, most_zones));
}

}  // namespace palpate::skeleton
