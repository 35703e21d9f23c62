#pragma once

#include <Eigen/Geometry>
#include <numbers>

#include "identify/models/body_model.h"
#include "mesh/core/contact.h"

namespace palpate::identify {

// Loads that a rig can make which made a set's own: what a diagnosis and a check propose next.

/// How many times the strongest load so far acts before it is taken off: what yields or sticks has to be passed. Design
/// choice: less shows less, more may break the body.
inline constexpr double overload = 1.5;

/// When a load that is held is read [s].
struct DwellTimes {
    double soon, late;
};
/// `last`: the time of the latest reading so far. What creeps goes with the logarithm of the time, so that a decade
/// beyond what is known tells most; a thousandth of it is at once. Where no times are told, after 100 s: design choice.
inline DwellTimes dwell_times(double last) {
    const double late = last > 0 ? 10 * last : 100;
    return {1e-3 * late, late};
}

/// The room's directions in the frame of a body that is turned by `degrees` about an axis of unit length: they turn the
/// other way.
inline Mat3 room_of_turned(const Vec3& axis, double degrees) {
    return Eigen::AngleAxisd(-degrees * std::numbers::pi / 180, axis).toRotationMatrix();
}

/// Contacts elsewhere, as strong and as wide as a set's own are on average.
class MeanPush {
public:
    void count(const mesh::Contact& contact) {
        force_ += contact.force.norm();
        radius_ += contact.radius;
        ++count_;
    }
    bool is_known() const { return count_ > 0; }
    double force() const { return force_ / count_; }  // [N]
    /// Inwards, along the mean normal of the skin within a twentieth of the body's size, so that one triangle does not
    /// decide it.
    mesh::Contact at(const BodyModel& model, const Vec3& point) const {
        constexpr double reach = 0.05;
        const Vec3 push = -force_ / count_ * model.normal_near(point, reach * model.size());
        return {.point = point, .force = push, .radius = radius_ / count_};
    }

private:
    double force_ = 0, radius_ = 0;
    int count_ = 0;
};

}  // namespace palpate::identify
