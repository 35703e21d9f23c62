#pragma once

#include <vector>

#include "mesh/core/actuator.h"
#include "mesh/core/contact.h"
#include "mesh/core/tool.h"

namespace palpate::identify {

/// Where an instant lies between two others: `share` of the way from `before` to `after`.
struct InstantBetween {
    int before = 0;  // index; -1: time 0, when nothing acts yet
    int after = 0;
    double share = 1;  // [0, 1]
};

/// The place of an instant among the times of a probe's states [s]. The first load is put on from time 0 on, the last
/// one stays. @pre times do not fall; there is one
InstantBetween place_among(const std::vector<double>& times, double instant);

/// Loads that change evenly from one state to the next, at a share of the way.
std::vector<mesh::Contact> between(const std::vector<mesh::Contact>& before, const std::vector<mesh::Contact>& after,
                                   double share);
std::vector<mesh::ActuatorSetting> between(const std::vector<mesh::ActuatorSetting>& before,
                                           const std::vector<mesh::ActuatorSetting>& after, double share);
/// What a tendon was set to before that matters to its friction (mesh::ActuatorSetting): from the largest value on,
/// where that is more than it is set to now.
std::vector<double> since_largest(const std::vector<double>& before, double now);
/// The same of tools that touch the body: one that is away before or after stays where it is `now`.
std::vector<mesh::ToolMotion> between(const std::vector<mesh::ToolMotion>& before,
                                      const std::vector<mesh::ToolMotion>& after, double share,
                                      std::vector<mesh::ToolMotion> now);

}  // namespace palpate::identify
