#pragma once

#include <string>
#include <vector>

#include "identify/population/population.h"

namespace palpate::pipeline {

/// What is pooled of a number: itself, its logarithm, or ln(1 - 2 nu) of a Poisson's ratio, which stays below 0.5.
enum class PoolScale { linear, logarithmic, compressibility };
/// As files have it.
const char* scale_name(PoolScale scale);
/// The number that is pooled as x.
double number_at(PoolScale scale, double x);

/// A number that several runs tell, each of its own specimen.
struct SharedNumber {
    std::string name;  // "young", "gravity:gx", "flexion"
    std::string unit;  // "1": none
    std::string of;    // what tells it: "finite elements", "the skeleton"
    PoolScale scale = PoolScale::linear;
    double most_spread = 0;  // as identify::pool takes it
    std::vector<identify::SpecimenNumber> specimens;
    std::vector<std::string> without;  // runs that do not tell it
};

}  // namespace palpate::pipeline
