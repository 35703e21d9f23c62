#pragma once

#include <string>

#include "identify/diagnosis/fit/refit.h"
#include "identify/measurements/measurement_set.h"

namespace palpate::identify {

/// The material that a fit comes to, with standard deviations: whichever is larger of the posterior's and of what the
/// probes disagree by.
struct MaterialEstimate {
    std::string law;
    double young = missing, young_sd = missing;      // [MPa]
    double poisson = missing, poisson_sd = missing;  // missing: the model has no such ratio
    bool poisson_is_declared = false;                // taken from the set, not fitted
};

MaterialEstimate material_of(const BodyModel& model, const Refit& fit);

}  // namespace palpate::identify
