#pragma once

#include <string>
#include <vector>

#include "mesh/progress.h"
#include "pipeline/analysis/quality/errors.h"
#include "pipeline/analysis/quality/probed_body.h"
#include "skeleton/model/model.h"

namespace palpate::pipeline {

/// A skeleton fitted to a body, link by link, and how far it is from it.
struct CalibratedQuality {
    skeleton::Model model;
    ErrorSummary fit;           // over the markers and probes that it was fitted to
    ErrorSummary held_out;      // over all of the free surface, under probes that it was not fitted to
    int overloaded_probes = 0;  // held-out probes whose load the skeleton does not bear
    double seconds = 0;         // of the fit
    std::vector<std::string> notes;
};

/// Fits as `identify` does by default, with few particles: they tell how sure the fit is, and do not change it.
/// `law`: of the skeleton.
CalibratedQuality calibrate_for_quality(const skeleton::Model& model, const ProbedQuality& body,
                                        skeleton::EquilibriumLaw law, int threads, const Progress& progress = {});

}  // namespace palpate::pipeline
