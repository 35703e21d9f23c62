#pragma once

#include <vector>

#include "pipeline/synthesis/specimen.h"

namespace palpate::pipeline {

/// How much an effect changes the readings, noise apart; rms over all coordinates [mm].
struct Strength {
    double displacement = 0;    // from rest, with nothing hidden
    double change = 0;          // of that by what is hidden
    double beyond = 0;          // what is left of the change after the best common scaling of the displacement: a body
                                // that is stiffer or softer throughout explains the rest
    void add(double variance);  // to what is changed [mm^2]
};

/// `baseline`, `hidden`: what is read, a row of the histories after the other; rows that are NaN do not count.
Strength strength_of(const Specimen& specimen, const std::vector<Points>& baseline, const std::vector<Points>& hidden);

/// The same of the forces of tools [N].
Strength strength_in_forces(const std::vector<Points>& bare, const std::vector<Points>& hidden);

/// rms over all coordinates [mm].
double rms(const std::vector<Points>& readings);

}  // namespace palpate::pipeline
