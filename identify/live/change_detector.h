#pragma once

#include <optional>

#include "identify/live/linearised_reading.h"
#include "identify/measurements/measurement_set.h"

namespace palpate::identify {

/// Since when, and where, a model no longer fits.
struct Alarm {
    StateName since;
    int marker = -1;          // of the set, whose readings are off by most; -1: none
    Vec3 at = Vec3::Zero();   // where it rests [mm]
    double whitened_rms = 0;  // of what is off there, in sigmas of the prediction's noise
};

/// Page's cumulative sum of the surprise of readings. [Page 1954]
///
/// -ln p of a reading is exponentially distributed as long as the model fits. Its sum, less 3 for each reading and
/// never below 0, alarms beyond 15. From 0 chance comes there with a probability below exp(-0.94 * 15) = 8e-7, as 0.94
/// solves exp(-3 t) = 1 - t (Wald). One reading counts 12 at the most: alone it is a slip, not a change.
struct ChangeDetector {
    double sum = 0;
    std::optional<StateName> since;  // when the sum rose from 0
    Eigen::VectorXd off;             // sums of squares of whitened errors of each marker since then (markers)
    int count = 0;                   // of readings since then

    void add(const StateName& name, double p, const StateReadings& readings, const LinearisedReading& local);
    std::optional<Alarm> alarm(const std::vector<Marker>& markers) const;
};

}  // namespace palpate::identify
