#pragma once

#include "skeleton/model/model.h"

namespace palpate::skeleton {

/// Young's modulus that a model's links stand for, the middle one [MPa]: kE L / A, with A the section of the smaller
/// sphere; 1 where no link tells any.
double link_modulus(const Model& model);

}  // namespace palpate::skeleton
