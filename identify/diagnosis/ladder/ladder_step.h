#pragma once

#include <optional>
#include <vector>

#include "identify/comparison/comparison.h"
#include "identify/diagnosis/material_estimate.h"
#include "identify/measurements/measurement_set.h"
#include "skeleton/model/model.h"

namespace palpate::identify {

/// Errors of one model, on what it was fitted to and on what it has not seen.
struct StepError {
    double rms_mm = 0, held_out_rms_mm = missing;                    // positions; 0 where none was measured
    double rms_n = missing, held_out_rms_n = missing;                // forces of tools; NaN where none was measured
    double relative = missing;                                       // as Comparison's, of all states
    double whitened_rms = missing, held_out_whitened_rms = missing;  // reference body only
};

/// A step: the effects that are in, and what is left then.
struct LadderStep {
    std::vector<skeleton::EffectRecord> effects;
    StepError skeleton;
    std::optional<StepError> reference;
    MaterialEstimate material;          // of the same body, fitted as `model` is
    double log_evidence = missing;      // of the reference body's fit, less the constant that the readings share
    double predicted_rms_mm = missing;  // of the reference body's positions, by the screen before it was fitted
    skeleton::Model model;              // with the effects in it; the last one is fitted to all states
    skeleton::Model validation_model;   // the same, fitted to what is not held out: rms_mm and held_out_rms_mm are its
    Comparison comparison;              // of that model with all states as they are understood by then
    MeasurementSet set;                 // measurements without the faults that are among the effects
};

}  // namespace palpate::identify
