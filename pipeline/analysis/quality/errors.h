#pragma once

#include <vector>

#include "identify/measurements/measurement_set.h"

namespace palpate::pipeline {

/// How far a model is from a measured state: lengths over all its readings.
struct ProbeDeviation {
    double error = 0;         // |modelled - measured| [mm]
    double displacement = 0;  // |measured - rest| [mm]
    double force = 0;         // of its contacts [N]
};

/// Relative errors of probes, error over displacement each.
struct ErrorSummary {
    int probes = 0;
    double rms = 0, median = 0, p90 = 0;  // over probes [-]
    double pooled = 0;                    // sqrt(sum error^2 / sum displacement^2), each probe's at equal force [-]
};

/// `predicted`: modelled marker positions of each state, in the order of its readings. States without contacts are
/// left out. @pre every reading has its marker.
std::vector<ProbeDeviation> deviations(const identify::MeasurementSet& set, const std::vector<Points>& predicted);

/// @pre there are deviations, with displacements and forces above 0.
ErrorSummary summarise(const std::vector<ProbeDeviation>& deviations);

}  // namespace palpate::pipeline
