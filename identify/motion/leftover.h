#pragma once

#include "identify/motion/ringing_fit.h"

namespace palpate::identify {

/// What a fit leaves of the recordings, and how much of it is said only once: errors of a model are alike from one
/// instant to the next and from marker to marker.
struct Leftover {
    double square = 0;       // of weighed errors
    int readings = 0;        // coordinates
    double independent = 0;  // of them
};

Leftover leftover(const RingingFit& fit, const Ringings& ringings, const Eigen::VectorXd& theta);

/// What errors' squares are to be divided by: their variance, times how many readings say the same. Noise that is told
/// is the least of it: errors are weighed by it already.
double variance_of(const Leftover& left, bool noise_is_told);

}  // namespace palpate::identify
