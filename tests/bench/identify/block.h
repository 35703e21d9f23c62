#pragma once

#include "identify/measurements/measurement_set.h"
#include "skeleton/model/model.h"

namespace palpate::bench {

/// A cube's lattice of n spheres a side, links of smoothly varying stiffness, and what moves at its surface.
struct Block {
    skeleton::Model start, truth;
    identify::MeasurementSet set;

    Block(int n, skeleton::EquilibriumLaw law);
};

}  // namespace palpate::bench
