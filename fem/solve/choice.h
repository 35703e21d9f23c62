#pragma once

#include "fem/solve/supernodes.h"

namespace palpate::fem {

/// Would conjugate gradients with multigrid be done with the loads of a body in 0.4 of the time that its
/// factor takes? `structure`: of the factor; three unknowns a node. False for 0 loads, which are not known.
bool is_sooner_without_factor(const Supernodes& structure, int loads);

}  // namespace palpate::fem
