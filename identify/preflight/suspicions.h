#pragma once

#include <array>
#include <vector>

#include "identify/diagnosis/problem.h"
#include "identify/measurements/measurement_set.h"

namespace palpate::identify {

enum class Suspect {
    rough,       // unlike its neighbours in this state
    jump,        // unlike the same marker before and after
    everywhere,  // unlike its neighbours in most states: the place at rest may be wrong
    far,         // rests off the body's surface, outside, and is attached to nothing
    exchanged,   // two markers that would fit with their names swapped
};
inline constexpr std::array<const char*, 5> suspect_names{"rough", "jump", "everywhere", "far", "exchanged"};

/// A reading, or a marker, that looks off before any fit.
struct Suspicion {
    Suspect kind = Suspect::rough;
    int state = -1;     // of the set; -1: all
    int marker = 0;     // of the set
    int other = -1;     // the marker that it may be exchanged with
    double mm = 0;      // by how much
    double sigmas = 0;  // the same in sigmas of its noise; 0 where that says nothing
};

/// `error_mm` (N): readings less what a linear body answers. What bends a whole region is no suspicion, what befell one
/// reading is. The worst first.
std::vector<Suspicion> suspicious_readings(const Problem& problem, const Eigen::VectorXd& error_mm);

/// Markers that rest outside the surface by more than 2 % of the body's size, without a point they are attached to.
std::vector<Suspicion> markers_off_the_surface(const MeasurementSet& set);

}  // namespace palpate::identify
