#pragma once

#include "samples/lattice.h"

namespace palpate::pipeline {

inline skeleton::Model exported_model() { return samples::make_lattice("cube", {3, 3, 2}, 1); }

}  // namespace palpate::pipeline
