#pragma once

#include <string>
#include <vector>

#include "identify/diagnosis/fit/refit.h"
#include "identify/measurements/measurement_set.h"

namespace palpate::identify {

/// Young's modulus of a region.
struct RegionEstimate {
    std::string name;
    double young = missing, young_sd = missing;  // [MPa]
    bool is_declared = false;                    // taken from the set, not fitted: without a deviation
};

/// The material that a fit comes to, with standard deviations: whichever is larger of the posterior's and of what the
/// probes disagree by.
struct MaterialEstimate {
    std::string law;
    double young = missing, young_sd = missing;      // [MPa]
    double poisson = missing, poisson_sd = missing;  // missing: the model has no such ratio
    bool poisson_is_declared = false;                // taken from the set, not fitted
    std::vector<RegionEstimate> regions = {};        // of materials of their own
};

MaterialEstimate material_of(const BodyModel& model, const Refit& fit);

}  // namespace palpate::identify
