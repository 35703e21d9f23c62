#pragma once

namespace palpate::identify {

/// The mean square error of a skeleton, shared out; the shares add up to 1.
struct ErrorBudget {
    double noise = 0;            // of the sensor
    double reduction = 0;        // the coarseness of spheres and links
    double missing_physics = 0;  // what a body of finite elements cannot explain either
};

/// Noise counts first, then what the reference body leaves beyond noise; the rest is the skeleton's own.
/// @param mean_square_error of the skeleton [mm^2]
/// @param noise_variance of the readings [mm^2]
/// @param left_by_reference mean square of the reference body's errors beyond the nuisances [mm^2]
ErrorBudget split_error_budget(double mean_square_error, double noise_variance, double left_by_reference);

}  // namespace palpate::identify
