#pragma once

#include <vector>

#include "mesh/types.h"

namespace palpate::identify {

/// Local misfit: squared whitened residuals summed over the states, tested against noise.
struct PlaceError {
    Vec3 at = Vec3::Zero();    // of a region: the mean of its markers at rest [mm]
    std::vector<int> markers;  // indices
    double rms_mm = 0, whitened_rms = 0;
    int coordinates = 0;   // that were measured; where there are none rms and p are NaN
    double p_value = 1;    // of chi^2, corrected for the many places [Holm 1979]
    bool strange = false;  // p < 0.05
};

struct ErrorLocations {
    std::vector<PlaceError> markers;  // one each, in order
    std::vector<PlaceError> regions;  // 12 or fewer, of three markers or more on average
};

/// Where a model fails: markers, and regions of markers round seeds that lie far from each other, whose residuals are
/// larger than noise. Model error correlates residuals, which only increases the significance of a region.
/// @param rest the markers' places (m x 3) [mm]
/// @param residual_mm of each state (m x 3) [mm]; NaN: missing
/// @param whitened the same in sigmas (m x 3)
ErrorLocations locate_misfit(const Points& rest, const std::vector<Points>& residual_mm,
                             const std::vector<Points>& whitened);

/// p-values of a family of tests, corrected so that one false alarm or more in the whole family has the probability
/// that is read off [Holm 1979]. NaN are no tests, and stay.
std::vector<double> holm(const std::vector<double>& p_values);

}  // namespace palpate::identify
