#pragma once

#include <string>
#include <vector>

#include "pipeline/forge/course.h"
#include "pipeline/forge/wish.h"

namespace palpate::pipeline {

/// What a body goes through from load to load: as asked for, and as those effects need it that show in time only.
struct Sequence {
    Rhythm rhythm;
    bool continuous = false;         // one body goes through all probes
    std::vector<std::string> notes;  // what nobody asked for, in words
};

/// What shows in what stays, as plasticity does, has one body go through all probes, let go after each; what shows in
/// time, as viscosity, is read 0.1, 4 and 20 s after a load was put on; unless told otherwise.
Sequence sequence_of(const ForgeOptions& options, const std::vector<Wish>& wishes);

}  // namespace palpate::pipeline
