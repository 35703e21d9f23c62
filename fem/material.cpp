#include "fem/material.h"

#include <fmt/format.h>

#include <algorithm>

#include "mesh/errors.h"

namespace palpate::fem {

void Material::validate() const {
    // Written so that NaN fails too.
    if (!(young > 0 && young < 1e12)) {
        throw InvalidInput(
            fmt::format("Young's modulus is {} MPa; allowed: more than 0, less than 1e12. Soft bodies have 0.001 to 10 "
                        "MPa: give `young` in MPa.",
                        young));
    }
    if (!(poisson > -1 && poisson < 0.5)) {
        throw InvalidInput(
            fmt::format("Poisson's ratio is {}; allowed: more than -1, less than 0.5. For an incompressible body give "
                        "0.499.",
                        poisson));
    }
    if (!(density >= 0 && density < 1)) {
        throw InvalidInput(fmt::format(
            "Density is {} tonne/mm^3; allowed: 0 to less than 1. 1000 kg/m^3 is 1e-9 tonne/mm^3.", density));
    }
}

double Materials::most_poisson() const {
    double most = body.poisson;
    for (const Material& region : regions) most = std::max(most, region.poisson);
    return most;
}

void Materials::validate() const {
    body.validate();
    for (const Material& region : regions) region.validate();
}

}  // namespace palpate::fem
