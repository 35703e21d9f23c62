#include "fem/large_deformation/body_equilibrium.h"

#include <fmt/format.h>

#include "mesh/errors.h"

namespace palpate::fem {

void NewtonOptions::validate() const {
    if (!(tolerance > 0 && tolerance < 1)) {
        throw InvalidInput(fmt::format(
            "tolerance (share of the load that may stay unbalanced) is {}; allowed: more than 0, less than 1.",
            tolerance));
    }
    if (iterations < 1) throw InvalidInput(fmt::format("iterations is {}; allowed: 1 and more.", iterations));
    if (load_steps < 0) throw InvalidInput(fmt::format("load_steps is {}; allowed: 0 and more.", load_steps));
}

}  // namespace palpate::fem
