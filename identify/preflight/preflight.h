#pragma once

#include <string>
#include <vector>

#include "identify/diagnosis/diagnose_options.h"
#include "identify/preflight/prospects/effect_prospects.h"
#include "identify/preflight/prospects/experiments.h"
#include "identify/preflight/prospects/parameter_prospects.h"
#include "identify/preflight/repeats.h"
#include "identify/preflight/suspicions.h"
#include "mesh/progress.h"

namespace palpate::identify {

/// What a measurement set is good for, judged before any fit.
///
/// The body answers at a guess of its stiffness: the set's own, or the one whose linear answers are as large as the
/// readings; under a law of large deformation where all loads have equilibria there. Effects are asked to first order
/// with the force signatures, the nuisances and the rules of the diagnosis.
struct Preflight {
    Explanation guess;           // what it is judged at
    bool guess_is_sets = false;  // Young's modulus of the set, else scaled to the readings
    bool tells_a_force = true;   // else stiffness is known up to a common factor
    bool noise_known = true;
    double noise_mm = 0;     // 1 sigma of a coordinate, rms
    double moved_mm = 0;     // how far markers were read from rest, rms of a coordinate
    double nuisance_mm = 0;  // what nobody can know about contacts and clamps, rms
    int coordinates = 0, independent = 0;
    ParameterProspects parameters;
    std::vector<EffectProspect> effects;  // in the order of the catalogue
    std::vector<Suspicion> suspicions;    // worst first, of each kind
    std::vector<Repeat> repeats;
    std::vector<ExperimentProspect> experiments;  // best first

    const EffectProspect* prospect_of(const std::string& name) const;
};

struct PreflightOptions {
    DiagnoseOptions diagnose;  // rules and threads
    bool experiments = true;   // what more states would bring, which takes as long as all the rest several times
};

/// @throws InvalidInput without labelled readings; SolverFailure where a state has no equilibrium.
Preflight assess(const BodyModel& model, const MeasurementSet& set, const PreflightOptions& options,
                 const Progress& progress = {});

}  // namespace palpate::identify
