#pragma once

#include <string>
#include <vector>

#include "identify/models/body_model.h"
#include "identify/set/measurement_set.h"
#include "skeleton/effects/effect.h"

namespace palpate::identify {

/// What is in force behind measurements that are made up, beside what their probes are told to do, and how they are
/// read.
struct World {
    Setting setting;
    double gain = 1;            // every second probe (2, 4, ...) presses so many times as hard as it reports
    Vec3 shift = Vec3::Zero();  // of the readings' frame [mm]
    Vec3 turn = Vec3::Zero();   // of it about the centre of the markers at rest, a rotation vector [rad]
    double off_share = 0;       // of the readings, that are off by themselves
    double off_width = 0;       // by so many sigmas of the noise

    /// Marker positions as they are read: y = c + shift + R(turn) (x - c), c the centre of the markers at rest.
    Points see(const std::vector<Marker>& rest, const Points& markers) const;
    /// What readings that are off by themselves add to the mean square [mm^2]; `noise`: 1 sigma [mm].
    double scatter(double noise) const;
};

/// What has to be done for an effect to show in measurements that are made up.
struct HidingNeeds {
    bool release = false;       // one body goes through all probes, let go after each: it shows in what stays
    bool dwells = false;        // loads are read at several times after they were put on
    bool noise = false;         // its numbers are told in sigmas
    bool told_poisson = false;  // the set tells a Poisson's ratio, which it belies
};

/// A number of an effect that is told. @pre it is.
double number_of(const skeleton::Effect& told, const std::string& name);

}  // namespace palpate::identify
