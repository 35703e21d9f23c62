#include "pipeline/case/run_diagnosis_options.h"

#include "identify/effects/catalogue.h"

namespace palpate::pipeline {

void RunDiagnosisOptions::validate() const {
    for (const std::string& name : without) identify::find_effect(name);
}

identify::DiagnoseOptions RunDiagnosisOptions::in_set(bool has_density) const {
    using identify::MagnitudeUse;
    identify::DiagnoseOptions options;
    options.without = without;
    options.false_claims = false_claims;
    if (gravity == GravityKnown::earth) options.refit.magnitude = MagnitudeUse::certain;
    if (gravity == GravityKnown::automatic && has_density) options.refit.magnitude = MagnitudeUse::alternative;
    return options;
}

}  // namespace palpate::pipeline
