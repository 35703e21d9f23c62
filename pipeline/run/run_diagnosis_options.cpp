#include "pipeline/run/run_diagnosis_options.h"

#include "identify/effects/catalogue.h"

namespace palpate::pipeline {

void RunDiagnosisOptions::validate() const {
    for (const std::string& name : without) identify::find_effect(name);
}

}  // namespace palpate::pipeline
