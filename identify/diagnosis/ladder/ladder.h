#pragma once

#include "identify/diagnosis/diagnosis.h"
#include "identify/diagnosis/ladder/ladder_options.h"
#include "identify/diagnosis/ladder/ladder_step.h"
#include "identify/inference/identify_result.h"
#include "identify/measurements/measurement_set.h"
#include "mesh/progress.h"

namespace palpate::identify {

/// An effect that would have made the model worse.
struct EffectNotAdded {
    std::string effect, why;
};

struct Ladder {
    std::vector<LadderStep> steps;  // nothing added first
    std::vector<EffectNotAdded> not_added;
    IdentifyResult identified;            // of the last step, on all states
    Diagnosis whole;                      // of the body with the last step's effects, on all states
    std::vector<int> held_out_probes;     // empty where there are too few to spare one
    Verdict verdict = Verdict::adequate;  // on the last step
    std::vector<std::string> notes;
};

/// Adds effects to a model, fits anew, and tells the error before and after, on fitted and on held-out probes.
///
/// `effects`: in the order of the steps. What they come to is found on `body`, the reference or the skeleton itself;
/// body effects then go into the skeleton and its stiffnesses are fitted again, faults of the measurement into how the
/// set is understood. A quarter of the loaded probes is held out, spread evenly; where there are eight or fewer, every
/// third probe in turn. The model of the last step is fitted to all. `diagnosis`: of the whole set by that body, where
/// there is one.
/// @throws InvalidInput, also where an effect cannot show in the body and the set; SolverFailure.
Ladder build_ladder(const skeleton::Model& model, const BodyModel& body, const MeasurementSet& set,
                    const std::vector<std::string>& effects, const LadderOptions& options,
                    const Diagnosis* diagnosis = nullptr, const Progress& progress = {});

}  // namespace palpate::identify
