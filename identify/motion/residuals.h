#pragma once

#include "identify/motion/ringing_fit.h"

namespace palpate::identify {

/// Residuals of a fit to the recordings, and their effective number: model errors are correlated in time and between
/// markers.
struct ResidualStatistics {
    double square = 0;       // of weighed errors
    int readings = 0;        // coordinates
    double independent = 0;  // of them
};

ResidualStatistics residuals(const RingdownFit& fit, const Ringdowns& ringdowns, const Eigen::VectorXd& theta);

/// What errors' squares are to be divided by: their variance, times how many readings say the same. Noise that is told
/// is the least of it: errors are weighed by it already.
double variance_of(const ResidualStatistics& left, bool noise_is_known);

}  // namespace palpate::identify
