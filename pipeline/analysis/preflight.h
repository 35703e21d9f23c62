#pragma once

#include <memory>
#include <optional>
#include <string>

#include "identify/measurements/measurement_set.h"
#include "identify/models/reference/reference_body.h"
#include "identify/preflight/preflight.h"
#include "mesh/progress.h"

namespace palpate::pipeline {

/// What a set is good for, before any fit.
struct PreflightOfSet {
    std::unique_ptr<identify::ReferenceBody> body = {};  // that it was judged on
    std::optional<identify::Preflight> preflight = {};   // absent: it could not be judged
    std::string why_none = {};                           // then
};

/// On a coarse body of finite elements: some seconds. `set`: with the supports that hold it.
PreflightOfSet judge(const identify::MeasurementSet& set, int threads, const Progress& progress);

}  // namespace palpate::pipeline
